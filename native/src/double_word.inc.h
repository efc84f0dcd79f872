/* Double-words over one scalar type: the unevaluated sum of two REALs, for the compensated
 * primitives. The includer's type has `fused` (real_*.h) and rounds to nearest.
 *
 * two_sum and two_product are exact (Knuth; fma). Sums and products below lose at most a few units
 * of REAL_UNIT^2 of their operands' magnitudes (Joldes, Muller and Popescu 2017, the sloppy sum
 * excepted: its error is relative to |a| + |b|, which is what the primitives' bounds ask for).
 */
typedef struct FN(double_word) {
  REAL h, l;
} FN(double_word);
#define DW FN(double_word)

static inline DW dw_make(REAL h, REAL l) { return (DW){h, l}; }
static inline DW dw_from(REAL h) { return (DW){h, from_double(0)}; }

/* |a| >= |b|, or a = 0. */
static inline DW dw_fast_sum(REAL a, REAL b) {
  REAL s = add(a, b);
  return dw_make(s, sub(b, sub(s, a)));
}

static inline DW dw_two_sum(REAL a, REAL b) {
  REAL s = add(a, b), t = sub(s, a);
  return dw_make(s, add(sub(a, sub(s, t)), sub(b, t)));
}

static inline DW dw_two_difference(REAL a, REAL b) { return dw_two_sum(a, neg(b)); }

static inline DW dw_two_product(REAL a, REAL b) {
  REAL p = mul(a, b);
  return dw_make(p, fused(a, b, neg(p)));
}

static inline DW dw_neg(DW a) { return dw_make(neg(a.h), neg(a.l)); }

static inline DW dw_add(DW a, DW b) {
  DW s = dw_two_sum(a.h, b.h);
  return dw_fast_sum(s.h, add(s.l, add(a.l, b.l)));
}

static inline DW dw_sub(DW a, DW b) { return dw_add(a, dw_neg(b)); }

static inline DW dw_mul(DW a, DW b) {
  DW p = dw_two_product(a.h, b.h);
  return dw_fast_sum(p.h, add(p.l, fused(a.h, b.l, mul(a.l, b.h))));
}

static inline DW dw_times(DW a, REAL b) {
  DW p = dw_two_product(a.h, b);
  return dw_fast_sum(p.h, fused(a.l, b, p.l));
}

static inline DW dw_square(DW a) {
  DW p = dw_two_product(a.h, a.h);
  REAL cross = mul(a.h, a.l);
  return dw_fast_sum(p.h, add(p.l, add(cross, cross)));
}

/* a > 0. */
static inline DW dw_root(DW a) {
  REAL h = root(a.h), rest = add(fused(neg(h), h, a.h), a.l);
  return dw_fast_sum(h, quo(rest, add(h, h)));
}

/* The quotient rounded to one REAL, error little more than half a unit in its last place. */
static inline REAL dw_quotient(DW a, DW b) {
  REAL q = quo(a.h, b.h);
  REAL rest = add(fused(neg(q), b.h, a.h), sub(a.l, mul(q, b.l)));
  return add(q, quo(rest, b.h));
}

static inline int dw_is_zero(DW a) {
  return !less(a.h, from_double(0)) && !less(from_double(0), a.h);
}

/* ---- Vectors ---- */

typedef struct FN(double_word3) {
  DW x, y, z;
} FN(double_word3);
#define DW3 FN(double_word3)

/* a - b, exact. */
static inline DW3 dw3_difference(VEC a, VEC b) {
  return (DW3){dw_two_difference(a.x, b.x), dw_two_difference(a.y, b.y),
               dw_two_difference(a.z, b.z)};
}

static inline DW dw3_dot(DW3 a, VEC b) {
  return dw_add(dw_add(dw_times(a.x, b.x), dw_times(a.y, b.y)), dw_times(a.z, b.z));
}

static inline DW dw3_square(DW3 a) {
  return dw_add(dw_add(dw_square(a.x), dw_square(a.y)), dw_square(a.z));
}

/* The dot product of two vectors of REALs. */
static inline DW dw_dot(VEC a, VEC b) {
  return dw_add(dw_add(dw_two_product(a.x, b.x), dw_two_product(a.y, b.y)),
                dw_two_product(a.z, b.z));
}

/* f + s*d. */
static inline DW3 dw3_along(DW3 f, DW s, VEC d) {
  return (DW3){dw_add(f.x, dw_times(s, d.x)), dw_add(f.y, dw_times(s, d.y)),
               dw_add(f.z, dw_times(s, d.z))};
}
