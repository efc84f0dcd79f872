/* The widest scalar type of this platform: what is computed once per frame is computed in it. */
#ifndef CT_WIDE_H
#define CT_WIDE_H

#if defined(__SIZEOF_FLOAT128__)
typedef __float128 ct_wide;
#else
typedef long double ct_wide;
#endif

#endif
