/* Vectors of three scalars, for the kernel text. The includer defines REAL, FN and the scalar
 * operations (real_*.h). Sums run x, y, z in that order on every path. */
typedef struct FN(vec) {
  REAL x, y, z;
} FN(vec);
#define VEC FN(vec)

static inline VEC v_make(REAL x, REAL y, REAL z) { return (VEC){x, y, z}; }

static inline VEC v_load(const double *p) {
  return v_make(from_double(p[0]), from_double(p[1]), from_double(p[2]));
}

static inline VEC v_load_wide(const ct_wide *p) {
  return v_make(from_wide(p[0]), from_wide(p[1]), from_wide(p[2]));
}

static inline void v_store(VEC a, double *out) {
  out[0] = to_double(a.x);
  out[1] = to_double(a.y);
  out[2] = to_double(a.z);
}

/* What v_store leaves. */
static inline void v_store_low(VEC a, double *out) {
  out[0] = to_low(a.x);
  out[1] = to_low(a.y);
  out[2] = to_low(a.z);
}

static inline VEC v_add(VEC a, VEC b) {
  return v_make(add(a.x, b.x), add(a.y, b.y), add(a.z, b.z));
}
static inline VEC v_sub(VEC a, VEC b) {
  return v_make(sub(a.x, b.x), sub(a.y, b.y), sub(a.z, b.z));
}
static inline VEC v_mul(VEC a, VEC b) {
  return v_make(mul(a.x, b.x), mul(a.y, b.y), mul(a.z, b.z));
}
static inline VEC v_neg(VEC a) { return v_make(neg(a.x), neg(a.y), neg(a.z)); }
static inline VEC v_scale(REAL s, VEC a) { return v_make(mul(s, a.x), mul(s, a.y), mul(s, a.z)); }
static inline VEC v_over(VEC a, REAL s) { return v_make(quo(a.x, s), quo(a.y, s), quo(a.z, s)); }

/* a + s*b: a point at distance s along b. */
static inline VEC v_along(VEC a, REAL s, VEC b) { return v_add(a, v_scale(s, b)); }

static inline REAL v_dot(VEC a, VEC b) {
  return add(add(mul(a.x, b.x), mul(a.y, b.y)), mul(a.z, b.z));
}

static inline REAL v_length(VEC a) { return root(v_dot(a, a)); }

static inline REAL larger(REAL a, REAL b) { return less(a, b) ? b : a; }

/* The largest magnitude of the components. */
static inline REAL v_extent(VEC a) {
  return larger(larger(magnitude(a.x), magnitude(a.y)), magnitude(a.z));
}

static inline VEC v_zero(void) {
  REAL zero = from_double(0);
  return v_make(zero, zero, zero);
}

/* An index of refraction as a fraction, so that 1/n is not rounded before it must be. */
typedef struct FN(index) {
  REAL over, under;
} FN(index);
#define INDEX FN(index)
