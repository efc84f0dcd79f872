/* Intervals over a type of upper bounds (bound_*.h): [lo, hi] is kept as (-lo, hi), so that one
 * direction of rounding serves both ends. Every operation returns a superset of the exact result;
 * products with, and differences of, exact zeros stay exact. */

typedef struct interval {
  BOUND nlo, hi; /* -lo and hi */
} IV;

static inline IV iv(BOUND nlo, BOUND hi) { return (IV){nlo, hi}; }
static inline IV i_from(double x) { return iv(b_from(-x), b_from(x)); }
static inline IV i_between(double lo, double hi) { return iv(b_from(-lo), b_from(hi)); }
static inline IV i_neg(IV a) { return iv(a.hi, a.nlo); }
static inline IV i_add(IV a, IV b) { return iv(b_add(a.nlo, b.nlo), b_add(a.hi, b.hi)); }
static inline IV i_sub(IV a, IV b) { return iv(b_add(a.nlo, b.hi), b_add(a.hi, b.nlo)); }

static inline BOUND b_max(BOUND a, BOUND b) { return b_less(a, b) ? b : a; }
static inline BOUND b_min(BOUND a, BOUND b) { return b_less(a, b) ? a : b; }

/* Certain comparisons: false also means "not certain". */
static inline int b_is_positive(BOUND a) { return b_less(b_from(0), a); }
static inline int b_is_negative(BOUND a) { return b_less(a, b_from(0)); }
static inline int i_is_positive(IV a) { return b_is_negative(a.nlo); }
static inline int i_is_negative(IV a) { return b_is_negative(a.hi); }
static inline int i_not_negative(IV a) { return !b_is_positive(a.nlo); }
static inline int i_not_positive(IV a) { return !b_is_positive(a.hi); }
static inline int i_is_zero(IV a) { return i_not_negative(a) && i_not_positive(a); }
static inline int i_less(IV a, IV b) { return b_less(a.hi, b_neg(b.nlo)); }
static inline int i_may_be_less(IV a, IV b) { return b_less(b_neg(a.nlo), b.hi); }

static inline IV i_mul(IV a, IV b) {
  if (i_not_negative(a)) {
    if (i_not_negative(b)) return iv(b_mul(a.nlo, b_neg(b.nlo)), b_mul(a.hi, b.hi));
    if (i_not_positive(b)) return iv(b_mul(a.hi, b.nlo), b_mul(b_neg(a.nlo), b.hi));
    return iv(b_mul(a.hi, b.nlo), b_mul(a.hi, b.hi));
  }
  if (i_not_positive(a)) {
    if (i_not_negative(b)) return iv(b_mul(a.nlo, b.hi), b_mul(a.hi, b_neg(b.nlo)));
    if (i_not_positive(b)) return iv(b_mul(b_neg(a.hi), b.hi), b_mul(a.nlo, b.nlo));
    return iv(b_mul(a.nlo, b.hi), b_mul(a.nlo, b.nlo));
  }
  if (i_not_negative(b)) return iv(b_mul(a.nlo, b.hi), b_mul(a.hi, b.hi));
  if (i_not_positive(b)) return iv(b_mul(a.hi, b.nlo), b_mul(a.nlo, b.nlo));
  return iv(b_max(b_mul(a.nlo, b.hi), b_mul(a.hi, b.nlo)),
            b_max(b_mul(a.nlo, b.nlo), b_mul(a.hi, b.hi)));
}

static inline IV i_square(IV a) {
  if (i_not_negative(a)) return iv(b_mul(a.nlo, b_neg(a.nlo)), b_mul(a.hi, a.hi));
  if (i_not_positive(a)) return iv(b_mul(b_neg(a.hi), a.hi), b_mul(a.nlo, a.nlo));
  BOUND far = b_max(a.nlo, a.hi);
  return iv(b_from(0), b_mul(far, far));
}

/* b certainly positive; the caller has looked. */
static inline IV i_over_positive(IV a, IV b) {
  BOUND lo = b_neg(b.nlo);
  return iv(b_is_positive(a.nlo) ? b_div(a.nlo, lo) : b_div(a.nlo, b.hi),
            b_is_positive(a.hi) ? b_div(a.hi, lo) : b_div(a.hi, b.hi));
}

/* b certainly not zero. */
static inline IV i_over(IV a, IV b) {
  return i_is_positive(b) ? i_over_positive(a, b) : i_over_positive(i_neg(a), i_neg(b));
}

/* The part at or above zero; what lies below is outside the domain of what follows. */
static inline IV i_floor_zero(IV a) {
  BOUND zero = b_from(0);
  return iv(b_min(a.nlo, zero), b_max(a.hi, zero));
}

/* Root of the part at or above zero. With s at or above the root of x, x/s is at or below it. */
static inline IV i_sqrt(IV a) {
  a = i_floor_zero(a);
  BOUND lo = b_neg(a.nlo);
  BOUND nlo = b_is_positive(lo) ? b_div(a.nlo, b_sqrt(lo)) : b_from(0);
  return iv(nlo, b_sqrt(a.hi));
}

static inline IV i_hull(IV a, IV b) { return iv(b_max(a.nlo, b.nlo), b_max(a.hi, b.hi)); }

/* What two enclosures of one number have in common. */
static inline IV i_meet(IV a, IV b) { return iv(b_min(a.nlo, b.nlo), b_min(a.hi, b.hi)); }

static inline BOUND i_magnitude(IV a) { return b_max(a.nlo, a.hi); }

/* Wider by `by` >= 0 at both ends. */
static inline IV i_widen(IV a, BOUND by) { return iv(b_add(a.nlo, by), b_add(a.hi, by)); }

/* x^eta for the part of x at or above zero and an exact integer eta >= 1, by repeated squaring. */
static inline IV i_integer_power(IV x, double eta) {
  IV base = i_floor_zero(x), result = i_from(1);
  for (;;) {
    double half = floor(eta / 2);
    if (eta - 2 * half > 0) result = i_mul(result, base);
    if (!(half > 0)) return result;
    base = i_square(base);
    eta = half;
  }
}

/* ---- Vectors of intervals ---- */

typedef struct interval3 {
  IV x, y, z;
} IV3;

static inline IV3 i3(IV x, IV y, IV z) { return (IV3){x, y, z}; }
static inline IV3 i3_from(const double *p) { return i3(i_from(p[0]), i_from(p[1]), i_from(p[2])); }
static inline IV3 i3_zero(void) { return i3(i_from(0), i_from(0), i_from(0)); }
static inline IV3 i3_neg(IV3 a) { return i3(i_neg(a.x), i_neg(a.y), i_neg(a.z)); }
static inline IV3 i3_add(IV3 a, IV3 b) {
  return i3(i_add(a.x, b.x), i_add(a.y, b.y), i_add(a.z, b.z));
}
static inline IV3 i3_sub(IV3 a, IV3 b) {
  return i3(i_sub(a.x, b.x), i_sub(a.y, b.y), i_sub(a.z, b.z));
}
static inline IV3 i3_mul(IV3 a, IV3 b) {
  return i3(i_mul(a.x, b.x), i_mul(a.y, b.y), i_mul(a.z, b.z));
}
static inline IV3 i3_scale(IV s, IV3 a) {
  return i3(i_mul(s, a.x), i_mul(s, a.y), i_mul(s, a.z));
}
static inline IV3 i3_over_positive(IV3 a, IV s) {
  return i3(i_over_positive(a.x, s), i_over_positive(a.y, s), i_over_positive(a.z, s));
}
static inline IV3 i3_along(IV3 a, IV s, IV3 b) { return i3_add(a, i3_scale(s, b)); }
static inline IV3 i3_hull(IV3 a, IV3 b) {
  return i3(i_hull(a.x, b.x), i_hull(a.y, b.y), i_hull(a.z, b.z));
}
static inline IV3 i3_widen(IV3 a, BOUND by) {
  return i3(i_widen(a.x, by), i_widen(a.y, by), i_widen(a.z, by));
}
static inline IV i3_dot(IV3 a, IV3 b) {
  return i_add(i_add(i_mul(a.x, b.x), i_mul(a.y, b.y)), i_mul(a.z, b.z));
}
static inline IV i3_square(IV3 a) {
  return i_add(i_add(i_square(a.x), i_square(a.y)), i_square(a.z));
}
static inline IV i3_length(IV3 a) { return i_sqrt(i3_square(a)); }
static inline IV3 i3_cross(IV3 a, IV3 b) {
  return i3(i_sub(i_mul(a.y, b.z), i_mul(a.z, b.y)), i_sub(i_mul(a.z, b.x), i_mul(a.x, b.z)),
            i_sub(i_mul(a.x, b.y), i_mul(a.y, b.x)));
}
static inline BOUND i3_magnitude(IV3 a) {
  return b_max(b_max(i_magnitude(a.x), i_magnitude(a.y)), i_magnitude(a.z));
}
