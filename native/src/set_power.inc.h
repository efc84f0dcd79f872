/* x^eta over intervals, 0 <= x and eta > 0, for the highlight of the specification's 3.2.
 *
 * Integer eta by repeated squaring. Any other by exp(eta log x) at both ends, as the power rises
 * with x: log m = 2 artanh((m - 1)/(m + 1)) for m near 1, exp r by Taylor's series for r / 256,
 * squared eight times. Every remainder is enclosed, so the result is, too.
 */

enum { SERIES_TERMS = 80 };

/* ln 2 as a sum of three doubles, within 2^-160. */
static IV ln2(void) {
  IV sum = i_add(i_from(0x1.62e42fefa39efp-1), i_from(0x1.abc9e3b39803fp-56));
  return i_widen(i_add(sum, i_from(0x1.7b57a079a1934p-111)), b_from(0x1p-160));
}

static IV log_of(BOUND x) {
  int exponent;
  double head = frexp(b_to_double(x), &exponent);
  if (head < 0.7071) exponent--;
  /* Powers of two are exact, but one step may leave the range. */
  BOUND m = b_mul(b_mul(x, b_from(ldexp(1, -exponent / 2))),
                  b_from(ldexp(1, -exponent - (-exponent / 2))));
  IV point = iv(b_neg(m), m), one = i_from(1);
  IV s = i_over_positive(i_sub(point, one), i_add(point, one)), square = i_square(s), term = s;
  IV sum = s;
  for (int k = 3; k < 2 * SERIES_TERMS; k += 2) {
    term = i_mul(term, square);
    IV next = i_over_positive(term, i_from(k));
    sum = i_add(sum, next);
    if (!b_less(b_from(0x1p-140), i_magnitude(next))) {
      /* The terms fall by s^2 < 0.03 each, so what is left is less than the last one. */
      sum = i_widen(sum, i_magnitude(next));
      break;
    }
  }
  return i_add(i_add(sum, sum), i_mul(i_from(exponent), ln2()));
}

static IV exp_of(IV y) {
  if (b_less(y.hi, b_from(-700))) return i_between(0, 0x1p-1000);
  double k = floor(b_to_double(y.hi) / 0.6931471805599453 + 0.5);
  IV r = i_mul(i_sub(y, i_mul(i_from(k), ln2())), i_from(0x1p-8));
  IV sum = i_add(i_from(1), r), term = r;
  for (int n = 2; n < SERIES_TERMS; n++) {
    term = i_over_positive(i_mul(term, r), i_from(n));
    sum = i_add(sum, term);
    if (!b_less(b_from(0x1p-140), i_magnitude(term))) {
      sum = i_widen(sum, i_magnitude(term));
      break;
    }
  }
  for (int i = 0; i < 8; i++) sum = i_square(i_floor_zero(sum));
  return i_mul(sum, i_from(ldexp(1, (int)k)));
}

/* Kept out of line: the loops are long and most highlights have an integer exponent. */
static __attribute__((noinline)) IV fractional_power(IV x, double eta) {
  BOUND lo = b_neg(x.nlo);
  IV high = exp_of(i_mul(i_from(eta), log_of(x.hi)));
  if (!b_is_positive(lo)) return iv(b_from(0), high.hi);
  IV low = exp_of(i_mul(i_from(eta), log_of(lo)));
  return iv(low.nlo, high.hi);
}

static IV set_power(IV x, double eta) {
  x = i_floor_zero(x);
  if (!b_is_positive(x.hi)) return i_from(0);
  return eta == floor(eta) ? i_integer_power(x, eta) : fractional_power(x, eta);
}
