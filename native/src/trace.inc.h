/* Whitted's recursion over the course's scenes (specification 3.2, 4.1, 4.2; Whitted 1980), for one
 * scalar type. The includer defines REAL, FN and the scalar operations (real_*.h), and includes
 * vector.inc.h, the primitives, world.inc.h, light.inc.h and scatter.inc.h before this text.
 *
 * Order of operations, which every code path must keep: terms of a hit as base + diffuse +
 * specular, lights in file order; then + kr * reflected, then + kt * refracted.
 */

static VEC FN(trace)(const WORLD *world, ct_pixel *pixel, const RAY *ray, SPLIT *split,
                     uint64_t *tree);

static VEC background(const WORLD *world) {
  return v_over(v_load(world->view->background), from_double(255));
}

static VEC secondary(const WORLD *world, ct_pixel *pixel, const RAY *ray, const HIT *hit,
                     VEC direction, const ct_medium *medium, int passes, REAL slack, uint64_t *tree) {
  if (ray->depth >= world->frame->max_depth) {
    if (world->choice[CT_EXHAUSTED] == CT_EXHAUSTED_BACKGROUND) {
      ON_UNSENT(pixel, background(world));
      return background(world);
    }
    return v_zero();
  }
  /* Of length 1 but for rounding, which would grow from bounce to bounce inside glass. */
  direction = NUDGED(pixel, v_over(direction, v_length(direction)));
  int64_t depth = passes ? ray->depth : ray->depth + 1;
  VEC origin = NUDGED_ORIGIN(pixel, offset_origin(world, ray, hit, direction, 0));
  RAY next = {origin, direction, depth, 0, medium, slack};
  /* A subtree has a hash of its own, so that subtrees may be traced in any order. */
  uint64_t subtree = 0;
  VEC color = FN(trace)(world, pixel, &next, NULL, &subtree);
  *tree = ct_tree_mix(*tree, subtree);
  return color;
}

/* ---- One ray ---- */

static VEC limit_returned(const WORLD *world, VEC c) {
  REAL one = from_double(1);
  if (world->choice[CT_RECURSION] == CT_RECURSION_CLAMP)
    return v_make(less(one, c.x) ? one : c.x, less(one, c.y) ? one : c.y,
                  less(one, c.z) ? one : c.z);
  REAL largest = larger(larger(c.x, c.y), c.z);
  if (world->choice[CT_RECURSION] == CT_RECURSION_SCALE && less(one, largest))
    return v_over(c, largest);
  return c;
}

static VEC shade(const WORLD *world, ct_pixel *pixel, const RAY *ray, const HIT *hit,
                 SPLIT *split, uint64_t *tree) {
  const double *m = world->view->material + (size_t)hit->object * CT_MATERIAL_COLUMNS;
  VEC color = v_over(v_load(world->view->color + 3 * hit->object), from_double(255));
  if (world->view->delivery == 1) {
    if (world->effects & CT_FLAT) split->base = color;
    return split->base;
  }
  if ((world->effects & CT_AMBIENT) && m[CT_KA] > 0)
    split->base = v_mul(v_scale(from_double(m[CT_KA]), color),
                        v_over(v_load(world->view->ambient), from_double(255)));
  add_lights(world, pixel, ray, hit, m, color, split, tree);
  if (world->view->delivery < 3) return v_add(v_add(split->base, split->diffuse), split->specular);

  ct_medium entered;
  SCATTER s = scatter_at(world, ray, hit, m, &entered);
  ON_SCATTER(world, pixel, ray, hit, &s);
  if (world->choice[CT_MIX] == CT_MIX_CONVEX) {
    REAL rest = sub(sub(from_double(1), s.kr), s.kt);
    split->base = v_scale(rest, split->base);
    split->diffuse = v_scale(rest, split->diffuse);
    split->specular = v_scale(rest, split->specular);
  }
  VEC sum = v_add(v_add(split->base, split->diffuse), split->specular);
  *tree = ct_tree_mix(*tree, (uint64_t)(s.inside | s.total << 1));
  REAL zero = from_double(0), part = zero;
  if (world->reach.slack > 0 && ray->depth < world->frame->max_depth)
    part = prune(world, ray, &s.kr, &s.kt);
  if (less(zero, s.kr)) {
    if (ray->depth < world->frame->max_depth) pixel->n_reflected++;
    ON_BRANCH(pixel, s.total ? CT_RAY_TOTALLY_REFLECTED : CT_RAY_REFLECTED, s.kr);
    VEC c = v_scale(s.kr, secondary(world, pixel, ray, hit, s.mirrored, ray->medium, 0,
                                     quo(part, s.kr), tree));
    *(s.total ? &split->total_reflection : &split->reflection) = c;
    sum = v_add(sum, c);
  }
  if (less(zero, s.kt)) {
    if (ray->depth < world->frame->max_depth) pixel->n_refracted++;
    ON_BRANCH(pixel, CT_RAY_REFRACTED, s.kt);
    split->refraction =
        v_scale(s.kt, secondary(world, pixel, ray, hit, s.refracted, s.medium, s.passes,
                           quo(part, s.kt), tree));
    sum = v_add(sum, split->refraction);
  }
  return sum;
}

static VEC FN(trace)(const WORLD *world, ct_pixel *pixel, const RAY *ray, SPLIT *split,
                     uint64_t *tree) {
  SPLIT own = {v_zero(), v_zero(), v_zero(), v_zero(), v_zero(), v_zero()};
  if (ct_pixel_must_stop(pixel, ray->depth)) return v_zero();
  HIT hit = FN(nearest)(world, pixel, ray);
  NUDGE_HIT(world, pixel, ray, &hit);
  *tree = ct_tree_mix(*tree, (uint64_t)(hit.object + 2));
  ON_RAY(world, pixel, ray, &hit);
  VEC color;
  if (hit.object >= 0)
    color = shade(world, pixel, ray, &hit, &own, tree);
  else if (ray->primary || world->choice[CT_MISS] == CT_MISS_BACKGROUND)
    color = own.base = background(world);
  else
    color = v_zero();
  if (split) *split = own;
  return RETURNED(pixel, &own, limit_returned(world, color));
}
