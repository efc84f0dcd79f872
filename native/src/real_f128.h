/* The compiler's __float128, 113 bits of significand, for the kernel text (see real_f64.h). Sums,
 * products and quotients are correctly rounded by the compiler's own support; no further library.
 *
 * Root: from the double root y0 (relative error 2^-53), y1 = y0 + (x - y0^2)/(2 y0) with the exact
 * residual (2^-105), then Newton's (y1 + x/y1)/2, whose two roundings leave less than 0.8 ulp.
 */
#ifndef CT_REAL_F128_H
#define CT_REAL_F128_H

#include <math.h>

#include "wide.h"

#define REAL __float128
#ifndef FN
#define FN(name) name##_f128
#endif
#define REAL_DIGITS 113
#define REAL_UNIT 0x1p-113
#define REAL_EXP_TERMS 25
#define REAL_LEAST_EXPONENT (-746) /* what double takes for 0 is 0, or ray trees would differ */
#define REAL_LEAST 0
#define REAL_CEILING 0x1p1000
#define CONSTANT(high, middle, low) \
  ((__float128)(high) + (__float128)(middle) + (__float128)(low))

static inline __float128 from_double(double x) { return x; }
static inline __float128 from_wide(ct_wide x) { return x; }
static inline double to_double(__float128 x) { return (double)x; }
static inline double to_low(__float128 x) { return (double)(x - (__float128)(double)x); }
static inline __float128 add(__float128 a, __float128 b) { return a + b; }
static inline __float128 sub(__float128 a, __float128 b) { return a - b; }
static inline __float128 mul(__float128 a, __float128 b) { return a * b; }
static inline __float128 quo(__float128 a, __float128 b) { return a / b; }
static inline __float128 neg(__float128 a) { return -a; }
static inline __float128 magnitude(__float128 a) { return a < 0 ? -a : a; }
static inline int less(__float128 a, __float128 b) { return a < b; }

static inline __float128 root(__float128 x) {
  __float128 unscale = 1;
  if (!(x > 0)) return x < 0 ? (__float128)NAN : 0;
  /* Into the middle of double's range by exact powers of two; rarely needed. */
  while (x < (__float128)0x1p-900) x *= (__float128)0x1p800, unscale *= (__float128)0x1p-400;
  while (x > (__float128)0x1p900) x *= (__float128)0x1p-800, unscale *= (__float128)0x1p400;
  double y0 = sqrt((double)x);
  __float128 rest = x - (__float128)y0 * y0;
  __float128 y1 = y0 + (__float128)((double)rest / (2 * y0));
  return (y1 + x / y1) / 2 * unscale;
}

static inline __float128 scale_by(__float128 x, int exponent) {
  for (; exponent < -1000; exponent += 1000) x *= (__float128)0x1p-1000;
  for (; exponent > 1000; exponent -= 1000) x *= (__float128)0x1p1000;
  return x * (__float128)ldexp(1, exponent);
}

/* x > 0 within double's range, as a significand of about [1/2, 1] and an exponent. */
static inline __float128 split_exponent(__float128 x, int *exponent) {
  (void)frexp((double)x, exponent);
  return scale_by(x, -*exponent);
}

#endif
