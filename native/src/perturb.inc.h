/* Random errors of the size of a rounding, where the set-valued kernel widens what it knows: in
 * directions, relative to 1, and in hits, relative to the magnitudes that they are the sum of.
 *
 * The numbers are counted, not drawn from a state: the k-th of a pixel's sample is a hash of k, so
 * that neither the thread nor the other pixels matter. One hash serves three components; 21 bits
 * each are plenty for an error.
 */

/* Uniform in [-1, 1). */
static inline REAL signed_unit(uint64_t bits) {
  return from_double(((double)(int64_t)(bits & 0x1fffff) - 0x1p20) * 0x1p-20);
}

static inline VEC nudged(ct_pixel *pixel, VEC a, REAL scale) {
  /* Adding 0 would turn -0 into 0. */
  if (!(pixel->error > 0)) return a;
  uint64_t bits = ct_tree_mix(pixel->stream, pixel->n_draws++);
  REAL size = mul(from_double(pixel->error), scale);
  return v_along(a, size, v_make(signed_unit(bits), signed_unit(bits >> 21),
                                 signed_unit(bits >> 42)));
}

#define NUDGED(pixel, direction) nudged(pixel, direction, from_double(1))

/* Where rounding is under test, nothing is decided exactly: that a light lies on a surface. */
#define IS_NUDGED(pixel) ((pixel)->error > 0)

/* Moves a hit, and with it the normal of a sphere. */
static inline void nudge_hit(const WORLD *world, ct_pixel *pixel, const RAY *ray, HIT *hit) {
  if (hit->object < 0 || !(pixel->error > 0)) return;
  hit->point = nudged(pixel, hit->point, add(v_extent(ray->origin), v_extent(hit->point)));
  hit->normal = object_normal(world, (size_t)hit->object, hit->point);
}

#define NUDGE_HIT nudge_hit
