/* Upper bounds in double-double, with the processor rounding to nearest.
 *
 * Method: the accurate algorithms of Joldes, Muller and Popescu (Tight and rigorous error bounds
 * for basic building blocks of double-word arithmetic, ACM TOMS 44, 2017) for sum (AccurateDWPlusDW,
 * 3u^2 + 13u^3), product (DWTimesDW3, 4u^2) and quotient (DWDivDW3, 9.8u^2), and Lefevre et al.
 * (2023) for the root (25/8 u^2), with u = 2^-53. Then 64u^2 |h| + 2^-960 is added to the low word
 * before the last normalisation, which covers each error, the rounding of that addition, and
 * underflow. A result of exactly zero is exact, as the errors are relative, and stays zero.
 */
#ifndef CT_BOUND_DD_H
#define CT_BOUND_DD_H

#include <fenv.h>
#include <math.h>

#include "double_double.h"

#define BOUND ct_dd
#if !defined(SET_FN)
#define SET_FN(name) name##_set_dd
#endif
#define SET_ROUNDING FE_TONEAREST

/* From a result within 64u^2 to a bound above it. */
static inline BOUND b_raise(BOUND a) {
  double slack = fma(0x1p-100, fabs(a.h), 0x1p-960);
  return fast_two_sum(a.h, a.l + slack);
}

static inline BOUND b_from(double x) { return (BOUND){x, 0}; }
static inline BOUND b_neg(BOUND a) { return (BOUND){-a.h, -a.l}; }

static inline BOUND b_add(BOUND a, BOUND b) {
  BOUND s = two_sum(a.h, b.h), t = two_sum(a.l, b.l);
  BOUND v = fast_two_sum(s.h, s.l + t.h);
  BOUND z = fast_two_sum(v.h, t.l + v.l);
  return z.h == 0 && z.l == 0 ? z : b_raise(z);
}

static inline BOUND b_mul(BOUND a, BOUND b) {
  if (a.h == 0 || b.h == 0) return (BOUND){0, 0};
  BOUND c = two_product(a.h, b.h);
  double tl = fma(a.h, b.l, a.l * b.l);
  double cl = fma(a.l, b.h, tl);
  return b_raise(fast_two_sum(c.h, c.l + cl));
}

static inline BOUND b_div(BOUND a, BOUND b) {
  if (a.h == 0) return (BOUND){0, 0};
  double th = 1 / b.h;
  double rh = fma(-b.h, th, 1), rl = -(b.l * th);
  BOUND e = two_sum(rh, rl);
  /* delta = e * th, then m = th + delta: the reciprocal of b. */
  BOUND c = two_product(e.h, th);
  BOUND delta = fast_two_sum(c.h, fma(e.l, th, c.l));
  BOUND m = fast_two_sum(th, delta.h);
  m = fast_two_sum(m.h, m.l + delta.l);
  BOUND p = two_product(a.h, m.h);
  double tl = fma(a.h, m.l, a.l * m.l);
  return b_raise(fast_two_sum(p.h, p.l + fma(a.l, m.h, tl)));
}

static inline BOUND b_sqrt(BOUND a) {
  if (!(a.h > 0)) return (BOUND){0, 0};
  double h = sqrt(a.h);
  double rest = fma(-h, h, a.h) + a.l;
  return b_raise(fast_two_sum(h, rest / (2 * h)));
}

static inline int b_less(BOUND a, BOUND b) { return a.h < b.h || (a.h == b.h && a.l < b.l); }

static inline double b_to_double(BOUND a) {
  return a.l > 0 ? nextafter(a.h, (double)INFINITY) : a.h;
}

#endif
