/* Vectors of three lanes, operation by operation as vector.inc.h has them of scalars. The includer
 * includes vector.inc.h and a lanes_*.h before. */
typedef struct FN(vecs) {
  LANES x, y, z;
} FN(vecs);
#define VECS FN(vecs)

static inline VECS vs_all(VEC a) { return (VECS){l_all(a.x), l_all(a.y), l_all(a.z)}; }
static inline VECS vs_add(VECS a, VECS b) { return (VECS){a.x + b.x, a.y + b.y, a.z + b.z}; }
static inline VECS vs_sub(VECS a, VECS b) { return (VECS){a.x - b.x, a.y - b.y, a.z - b.z}; }
static inline VECS vs_mul(VECS a, VECS b) { return (VECS){a.x * b.x, a.y * b.y, a.z * b.z}; }
static inline VECS vs_neg(VECS a) { return (VECS){-a.x, -a.y, -a.z}; }
static inline VECS vs_scale(LANES s, VECS a) { return (VECS){s * a.x, s * a.y, s * a.z}; }
static inline VECS vs_over(VECS a, LANES s) { return (VECS){a.x / s, a.y / s, a.z / s}; }
static inline VECS vs_along(VECS a, LANES s, VECS b) { return vs_add(a, vs_scale(s, b)); }
static inline LANES vs_dot(VECS a, VECS b) { return (a.x * b.x + a.y * b.y) + a.z * b.z; }
static inline LANES vs_length(VECS a) { return l_root(vs_dot(a, a)); }

static inline VECS vs_lesser_where(MASK m, VECS a, VECS b) {
  return (VECS){l_lesser_where(m, a.x, b.x), l_lesser_where(m, a.y, b.y),
                l_lesser_where(m, a.z, b.z)};
}
static inline VECS vs_greater_where(MASK m, VECS a, VECS b) {
  return (VECS){l_greater_where(m, a.x, b.x), l_greater_where(m, a.y, b.y),
                l_greater_where(m, a.z, b.z)};
}
static inline VECS vs_blend(MASK m, VECS a, VECS b) {
  return (VECS){l_blend(m, a.x, b.x), l_blend(m, a.y, b.y), l_blend(m, a.z, b.z)};
}
static inline VECS vs_add_where(MASK m, VECS a, VECS b) {
  return (VECS){l_add_where(m, a.x, b.x), l_add_where(m, a.y, b.y), l_add_where(m, a.z, b.z)};
}

static inline VECS vs_pack(MASK m, VECS a) {
  return (VECS){l_pack(m, a.x), l_pack(m, a.y), l_pack(m, a.z)};
}
static inline VECS vs_unpack(MASK m, VECS a) {
  return (VECS){l_unpack(m, a.x), l_unpack(m, a.y), l_unpack(m, a.z)};
}

/* Three arrays side by side. */
typedef struct FN(columns) {
  REAL *x, *y, *z;
} FN(columns);
#define COLUMNS FN(columns)

static inline VECS vs_load(const COLUMNS *c, size_t at) {
  return (VECS){l_load(c->x + at), l_load(c->y + at), l_load(c->z + at)};
}
static inline void vs_store(const COLUMNS *c, size_t at, VECS a) {
  l_store(c->x + at, a.x);
  l_store(c->y + at, a.y);
  l_store(c->z + at, a.z);
}
