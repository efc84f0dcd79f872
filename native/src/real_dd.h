/* Double-double, the unevaluated sum of two doubles with |l| <= ulp(h)/2, for the kernel text.
 *
 * Method: Joldes, Muller and Popescu, Tight and rigorous error bounds for basic building blocks of
 * double-word arithmetic, ACM TOMS 44 (2017): sum AccurateDWPlusDW, relative error 3u^2 + 13u^3;
 * product DWTimesDW3, 4u^2; quotient DWDivDW3, 9.8u^2. Root: Lefevre, Louvet, Muller, Picot and
 * Rideau, Accurate calculation of Euclidean norms using double-word arithmetic (2023), 25/8 u^2.
 * u = 2^-53, rounding to nearest.
 *
 * Special cases: where the low word of a product underflows (|result| < 2^-969) the error is
 * absolute, 2^-1074. A result beyond double's range has a NaN for its low word, and a quotient by
 * less than 2^-1022 is NaN: scenes end at 1e100, and a comparison with NaN is false, a miss.
 */
#ifndef CT_REAL_DD_H
#define CT_REAL_DD_H

#include <math.h>

#include "double_double.h"
#include "wide.h"

#define REAL ct_dd
#ifndef FN
#define FN(name) name##_dd
#endif
#define REAL_DIGITS 106
#define REAL_UNIT 0x1p-104
#define REAL_EXP_TERMS 24
#define REAL_LEAST_EXPONENT (-746)
#define REAL_LEAST 0
#define REAL_CEILING 0x1p1000
#define CONSTANT(high, middle, low) {(high), (middle)}

static inline ct_dd from_double(double x) { return (ct_dd){x, 0}; }
static inline ct_dd from_wide(ct_wide x) {
  double h = (double)x;
  return (ct_dd){h, (double)(x - (ct_wide)h)};
}
static inline double to_double(ct_dd x) { return x.h; }
static inline double to_low(ct_dd x) { return x.l; }
static inline ct_dd neg(ct_dd a) { return (ct_dd){-a.h, -a.l}; }

static inline ct_dd add(ct_dd a, ct_dd b) {
  ct_dd s = two_sum(a.h, b.h), t = two_sum(a.l, b.l);
  ct_dd v = fast_two_sum(s.h, s.l + t.h);
  return fast_two_sum(v.h, t.l + v.l);
}

static inline ct_dd sub(ct_dd a, ct_dd b) { return add(a, neg(b)); }

static inline ct_dd mul(ct_dd a, ct_dd b) {
  ct_dd c = two_product(a.h, b.h);
  double low = fma(a.h, b.l, a.l * b.l);
  return fast_two_sum(c.h, c.l + fma(a.l, b.h, low));
}

static inline ct_dd quo(ct_dd a, ct_dd b) {
  double t = 1 / b.h;
  /* What t lacks of the reciprocal of b, relatively: exact in h, one rounding in l. */
  ct_dd e = fast_two_sum(fma(-b.h, t, 1), -(b.l * t));
  ct_dd c = two_product(e.h, t);
  ct_dd delta = fast_two_sum(c.h, fma(e.l, t, c.l));
  ct_dd s = two_sum(delta.h, t);
  ct_dd m = fast_two_sum(s.h, delta.l + s.l);
  ct_dd p = two_product(a.h, m.h);
  return fast_two_sum(p.h, p.l + fma(a.l, m.h, a.h * m.l));
}

static inline ct_dd root(ct_dd a) {
  if (!(a.h > 0)) return (ct_dd){a.h < 0 ? (double)NAN : 0, 0};
  double h = sqrt(a.h);
  return fast_two_sum(h, (fma(-h, h, a.h) + a.l) / (2 * h));
}

static inline ct_dd magnitude(ct_dd a) { return a.h < 0 ? neg(a) : a; }
static inline int less(ct_dd a, ct_dd b) { return a.h < b.h || (a.h == b.h && a.l < b.l); }

static inline ct_dd scale_by(ct_dd x, int exponent) {
  return (ct_dd){ldexp(x.h, exponent), ldexp(x.l, exponent)};
}
static inline ct_dd split_exponent(ct_dd x, int *exponent) {
  double head = frexp(x.h, exponent);
  return (ct_dd){head, ldexp(x.l, -*exponent)};
}

#endif
