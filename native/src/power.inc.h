/* x^eta for the highlight of the specification's 3.2, x > 0 and eta > 0, for one scalar type.
 *
 * Made of the type's sums, products and quotients and of exact powers of two, with no library
 * function, so that every path that keeps this order of operations returns the same bits.
 *
 * Integer eta up to 1024: repeated squaring, relative error (1 + w)^(eta - 1) - 1, where w is that
 * of one product: each factor that is multiplied in brings one rounding, and there are eta - 1 of
 * them in the end. A point's r.wo carries as much error by itself.
 *
 * Any other: exp(eta ln x). x = 2^k m with m in [sqrt(1/2), sqrt(2)), ln m = 2 artanh(s) with
 * s = (m - 1)/(m + 1), |s| < 0.1716; exp(y) = 2^n exp(r) with |r| < 0.3535. Both series run until
 * the rest is below an eighth of the last place. Relative error at most (4 + 8 |eta ln x|) units
 * REAL_UNIT, measured below (2 + 4 |eta ln x|) (tests/test_power.c).
 *
 * Special cases: a result below double's least is 0 in every type, as whether there is a highlight
 * is a decision of the ray tree; in float, what lies between is 2^-126 (REAL_LEAST). Nothing
 * exceeds REAL_CEILING; only vectors that are not of length 1 (plane_normal=raw) lead there.
 * eta ln x = 0 gives 1.
 */
#include "power_tables.inc.h"

enum { LOG_TERMS = REAL_DIGITS / 5 + 1, GREATEST_SQUARED = 1024 };

/* ln(1 + d) for 1 + d from sqrt(1/2) to sqrt(2). */
static inline REAL log1p_of(REAL d) {
  REAL s = quo(d, add(from_double(2), d)), square = mul(s, s);
  REAL sum = odd_reciprocal[LOG_TERMS - 1];
  for (int j = LOG_TERMS - 2; j > 0; j--) sum = add(mul(sum, square), odd_reciprocal[j]);
  /* The leading term last: its rounding is the only one of weight. */
  s = add(s, s);
  return add(s, mul(mul(s, square), sum));
}

static inline REAL log_of(REAL x) {
  int exponent;
  REAL m = split_exponent(x, &exponent);
  if (less(m, from_double(0x1.6a09e667f3bcdp-1))) {
    m = scale_by(m, 1);
    exponent--;
  }
  REAL log_m = log1p_of(sub(m, from_double(1)));
  return exponent ? add(mul(from_double(exponent), ln_2), log_m) : log_m;
}

static inline REAL exp_of(REAL y) {
  REAL one = from_double(1);
  if (less(y, from_double(REAL_LEAST_EXPONENT))) return from_double(0);
  if (less(from_double(1000), y)) return from_double(REAL_CEILING);
  double n = floor(to_double(y) * 0x1.71547652b82fep0 + 0.5);
  REAL r = sub(y, mul(from_double(n), ln_2));
  REAL sum = factorial_reciprocal[REAL_EXP_TERMS - 1];
  for (int j = REAL_EXP_TERMS - 2; j > 1; j--) sum = add(mul(sum, r), factorial_reciprocal[j]);
  sum = add(one, add(r, mul(mul(r, r), sum)));
  return scale_by(sum, (int)n);
}

static inline REAL squared_power(REAL x, unsigned eta) {
  REAL result = from_double(1);
  for (;;) {
    if (eta & 1) result = mul(result, x);
    eta >>= 1;
    if (!eta) return result;
    x = mul(x, x);
  }
}

/* Between nothing that a double can hold and REAL_CEILING. */
static inline REAL within_range(REAL power) {
  REAL ceiling = from_double(REAL_CEILING);
  if (!(to_double(power) > 0)) return from_double(0);
  return less(ceiling, power) ? ceiling : power;
}

/* x^eta where it is too small for the type. */
static inline REAL underflown_power(REAL log_x, double eta) {
  int is_nothing = REAL_LEAST == 0 || eta * to_double(log_x) < REAL_LEAST_EXPONENT;
  return from_double(is_nothing ? 0 : REAL_LEAST);
}

/* exp(eta * log_x). */
static inline REAL exponential_power(REAL log_x, double eta) {
  REAL zero = from_double(0);
  if (!less(zero, magnitude(log_x))) return from_double(1); /* also where eta overflows the type */
  REAL power = within_range(exp_of(mul(from_double(eta), log_x)));
  return less(zero, power) ? power : underflown_power(log_x, eta);
}

static inline REAL power_of(REAL x, double eta) {
  REAL one = from_double(1);
  if (eta > GREATEST_SQUARED || eta != floor(eta)) return exponential_power(log_of(x), eta);
  /* By the reciprocal where squares could leave the range. */
  int inverts = less(from_double(1.5), x);
  REAL power = within_range(squared_power(inverts ? quo(one, x) : x, (unsigned)eta));
  if (inverts)
    return less(from_double(1 / REAL_CEILING), power) ? quo(one, power) : from_double(REAL_CEILING);
  return less(from_double(0), power) ? power : underflown_power(log_of(x), eta);
}
