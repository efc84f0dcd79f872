/* Random errors of the size of a rounding, where the set-valued kernel widens what it knows: in
 * directions, relative to 1, and in distances and points, relative to the magnitudes that they are
 * the sum of.
 *
 * The numbers are counted, not drawn from a state: the k-th of a pixel's sample is a hash of k, so
 * that neither the thread nor the other pixels matter. One hash serves three components; 21 bits
 * each are plenty for an error.
 */

/* Uniform in [-1, 1). */
static inline REAL signed_unit(uint64_t bits) {
  return from_double(((double)(int64_t)(bits & 0x1fffff) - 0x1p20) * 0x1p-20);
}

static inline VEC nudged(ct_pixel *pixel, VEC a, VEC scale) {
  /* Adding 0 would turn -0 into 0. */
  if (!(pixel->error > 0)) return a;
  uint64_t bits = ct_tree_mix(pixel->stream, pixel->n_draws++);
  VEC u = v_make(signed_unit(bits), signed_unit(bits >> 21), signed_unit(bits >> 42));
  return v_along(a, from_double(pixel->error), v_mul(scale, u));
}

/* A root t of a sphere that is c/q, of the other root q and c = |o - C|^2 - r^2, errs with that
 * difference of squares: near the surface of a large sphere by much more than with t itself. */
static REAL nudged_distance(const WORLD *world, ct_pixel *pixel, const RAY *ray, size_t i, REAL t) {
  if (!(pixel->error > 0)) return t;
  REAL scale = add(v_extent(ray->origin), t);
  if (world->view->kind[i] == CT_SPHERE) {
    const double *g = world->view->geometry + i * CT_GEOMETRY_COLUMNS;
    VEC f = v_sub(ray->origin, v_load(g));
    REAL b = neg(v_dot(f, ray->direction)), r = from_double(g[3]);
    REAL other = magnitude(sub(add(b, b), t));
    if (less(t, other)) scale = add(scale, quo(add(v_dot(f, f), mul(r, r)), other));
  }
  /* Drawn by the root itself: two surfaces that are textually the same stay an exact tie. */
  union { double value; uint64_t bits; } root = {to_double(t)};
  REAL u = signed_unit(ct_tree_mix(ct_tree_mix(pixel->stream, pixel->n_draws), root.bits));
  return add(t, mul(mul(from_double(pixel->error), scale), u));
}

static inline VEC all_alike(REAL scale) { return v_make(scale, scale, scale); }

#define NUDGED(pixel, direction) nudged(pixel, direction, all_alike(from_double(1)))

/* Where rounding is under test, nothing is decided exactly: that a light lies on a surface. */
#define IS_NUDGED(pixel) ((pixel)->error > 0)

/* The sum of two points errs in each component by its own magnitude, so that a hit of a plane z = 0
 * from near it is as good as exact in z; a renderer that rotates its rays errs by the largest.
 * Decisions that hang on a thousandth of a unit can tell, so samples take turns. */
static inline VEC sum_scale(const ct_pixel *pixel, VEC a, VEC b) {
  if (!pixel->by_component) return all_alike(add(v_extent(a), v_extent(b)));
  return v_make(add(magnitude(a.x), magnitude(b.x)), add(magnitude(a.y), magnitude(b.y)),
                add(magnitude(a.z), magnitude(b.z)));
}

/* Moves a hit, and with it the normal of a sphere. */
static inline void nudge_hit(const WORLD *world, ct_pixel *pixel, const RAY *ray, HIT *hit) {
  pixel->n_draws++; /* the distances' draw */
  if (hit->object < 0 || !(pixel->error > 0)) return;
  hit->point = nudged(pixel, hit->point, sum_scale(pixel, ray->origin, hit->point));
  hit->normal = object_normal(world, (size_t)hit->object, hit->point);
}

/* Where a ray starts is rounded once more: two rays from one hit may begin on two sides of it. */
#define NUDGED_ORIGIN(pixel, origin) nudged(pixel, origin, sum_scale(pixel, v_zero(), origin))

#define NUDGE_HIT nudge_hit
