/* The kernel in the compiler's __float128, where there is one. */
#if defined(__SIZEOF_FLOAT128__)
#include "real_f128.h"

#define CT_RUNG "f128"
#define CT_PRIMITIVES "prim_plain.inc.h"
#define CT_STACK_PER_LEVEL 6144
#define CT_TAKES_ROUNDING 0
#include "kernel.inc.h"
#else
typedef int ct_no_f128; /* a translation unit may not be empty */
#endif
