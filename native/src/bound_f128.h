/* Upper bounds in __float128: the compiler's soft-float honours FE_UPWARD (libgcc reads the
 * processor's mode), so sums, products and quotients are at or above the exact value. The root is
 * two Newton steps from the double root, within 2^-108, raised by that much. */
#ifndef CT_BOUND_F128_H
#define CT_BOUND_F128_H

#include <fenv.h>
#include <math.h>

typedef __float128 ct_f128_bound;

#define BOUND ct_f128_bound
#define SET_FN(name) name##_set_f128
#define SET_ROUNDING FE_UPWARD

static inline BOUND b_from(double x) { return x; }
static inline BOUND b_neg(BOUND a) { return -a; }
static inline BOUND b_add(BOUND a, BOUND b) { return a + b; }
static inline BOUND b_mul(BOUND a, BOUND b) { return a * b; }
static inline BOUND b_div(BOUND a, BOUND b) { return a / b; }
static inline int b_less(BOUND a, BOUND b) { return a < b; }
static inline double b_to_double(BOUND a) { return (double)a; }

static inline BOUND b_sqrt(BOUND a) {
  BOUND up = 1, tiny = (BOUND)0x1p-1000 * (BOUND)0x1p-1000;
  if (!(a > 0)) return 0;
  /* Into double's range by exact powers of two; a scene's numbers need at most two steps. */
  while (a < (BOUND)0x1p-900) a *= (BOUND)0x1p800, up *= (BOUND)0x1p-400;
  while (a > (BOUND)0x1p900) a *= (BOUND)0x1p-800, up *= (BOUND)0x1p400;
  BOUND y = (BOUND)sqrt((double)a);
  y = (y + a / y) / 2;
  y = (y + a / y) / 2;
  return (y + y * (BOUND)0x1p-107) * up + tiny;
}

#endif
