/* Whitted's recursion over the course's scenes (specification 3.2, 4.1, 4.2; Whitted 1980), for one
 * scalar type. The includer defines REAL, FN and the scalar operations (real_*.h), and includes
 * vector.inc.h and the primitives before this text.
 *
 * Order of operations, which every code path must keep: terms of a hit as base + diffuse +
 * specular, lights in file order; then + kr * reflected, then + kt * refracted.
 */

typedef struct FN(world) {
  const ct_frame *frame;
  const ct_scene_view *view;
  const int *choice;
  unsigned effects;
  VEC *plane_normal; /* unit, in this type */
  VEC u, v, w, eye;
  REAL epsilon, shadow_min, far;
  int has_far;
} FN(world);
#define WORLD FN(world)

typedef struct FN(ray) {
  VEC origin, direction; /* direction of length 1 */
  int64_t depth;
  int primary;
  const ct_medium *medium; /* nesting=tracked only */
} FN(ray);
#define RAY FN(ray)

typedef struct FN(hit) {
  int64_t object; /* -1: none */
  REAL t;
  VEC point, normal; /* the normal as in the file, unit */
} FN(hit);
#define HIT FN(hit)

typedef struct FN(split) {
  VEC base, diffuse, specular, reflection, refraction, total_reflection;
} FN(split);
#define SPLIT FN(split)

static VEC FN(trace)(const WORLD *world, ct_pixel *pixel, const RAY *ray, SPLIT *split,
                     uint64_t *tree);

static inline VEC object_normal(const WORLD *world, size_t i, VEC point) {
  const double *g = world->view->geometry + i * CT_GEOMETRY_COLUMNS;
  if (world->view->kind[i] == CT_PLANE) return world->plane_normal[world->frame->plane_slot[i]];
  /* Divided by its own length, not by the radius: the hit lies a rounding off the sphere, and a
   * normal of another length than 1 grows that error fivefold with every reflection inside. */
  VEC outward = v_sub(point, v_load(g));
  return v_over(outward, v_length(outward));
}

/* The nearest root of one object beyond t_min, 0: none. */
static inline REAL object_nearest(const WORLD *world, size_t i, VEC origin, VEC direction,
                                  int primary, REAL t_min) {
  const double *g = world->view->geometry + i * CT_GEOMETRY_COLUMNS;
  /* Mitsuba's near plane starts a primary ray off the surface that the eye lies on. */
  int on_surface = primary && world->frame->eye_on[i] &&
                   world->choice[CT_OFFSET] != CT_OFFSET_MITSUBA;
  if (world->view->kind[i] == CT_SPHERE)
    return sphere_nearest(origin, direction, v_load(g), from_double(g[3]), on_surface, t_min);
  if (on_surface) return from_double(0);
  return plane_nearest(origin, direction, v_load(g),
                       world->plane_normal[world->frame->plane_slot[i]], t_min);
}

static HIT FN(nearest)(const WORLD *world, const RAY *ray) {
  HIT hit = {.object = -1};
  REAL zero = from_double(0);
  for (size_t i = 0; i < world->view->n_objects; i++) {
    REAL t = object_nearest(world, i, ray->origin, ray->direction, ray->primary, zero);
    if (!less(zero, t) || (world->has_far && less(world->far, t))) continue;
    if (hit.object >= 0 && !less(t, hit.t)) continue; /* a tie stays with the first in the file */
    hit.object = (int64_t)i;
    hit.t = t;
  }
  if (hit.object >= 0) {
    hit.point = v_along(ray->origin, hit.t, ray->direction);
    hit.normal = object_normal(world, (size_t)hit.object, hit.point);
  }
  return hit;
}

/* ---- Offsets (design, section 1) ---- */

/* Mitsuba's RayEpsilon and ShadowEpsilon: 1500 and 15000 halves of a float's unit in the last
 * place (its math.h), and its near plane. */
#define MITSUBA_RAY_EPSILON 0x1.77p-14
#define MITSUBA_SHADOW_EPSILON 0x1.d4cp-11
#define MITSUBA_NEAR 1e-2

/* Where a ray leaving the hit along `toward` starts. */
static VEC offset_origin(const WORLD *world, const RAY *ray, const HIT *hit, VEC toward,
                         int is_shadow) {
  REAL side = v_dot(hit->normal, toward);
  VEC outward = less(side, from_double(0)) ? v_neg(hit->normal) : hit->normal;
  if (!is_shadow && world->choice[CT_EPSILON_FOR] == CT_EPSILON_FOR_SHADOW) return hit->point;
  switch (world->choice[CT_OFFSET]) {
    case CT_OFFSET_NORMAL: return v_along(hit->point, world->epsilon, outward);
    case CT_OFFSET_MITSUBA: {
      REAL step = mul(add(from_double(1), v_extent(hit->point)), from_double(MITSUBA_RAY_EPSILON));
      return v_along(hit->point, step, outward);
    }
    case CT_OFFSET_BOUND: {
      /* The point o + t*d, and a later test of it against the same surface, carry at most about
       * 16 roundings of the magnitudes that they are made of; twice that along the normal clears
       * it (after Pharr, Jakob and Humphreys, 6.8). */
      const double *g = world->view->geometry + hit->object * CT_GEOMETRY_COLUMNS;
      REAL reach = add(add(v_extent(ray->origin), v_extent(hit->point)), magnitude(hit->t));
      reach = add(reach, v_extent(v_load(g)));
      if (world->view->kind[hit->object] == CT_SPHERE) reach = add(reach, from_double(g[3]));
      return v_along(hit->point, mul(reach, from_double(32 * REAL_UNIT)), outward);
    }
    default: return v_along(hit->point, world->epsilon, toward);
  }
}

/* ---- Shadows (specification 3.2, 3.3) ---- */

/* Where a light lies on a sphere, one root is the light itself, and the other 2b minus it. */
static int blocks_own_light(const WORLD *world, size_t i, VEC origin, VEC direction, REAL limit) {
  const double *g = world->view->geometry + i * CT_GEOMETRY_COLUMNS;
  if (world->view->kind[i] == CT_PLANE) return 0;
  REAL b = neg(v_dot(v_sub(origin, v_load(g)), direction));
  REAL other = sub(mul(from_double(2), b), limit);
  return less(world->shadow_min, other) && less(other, limit);
}

/* Does any object stand between the hit and light j? `to_light` is of length 1, `distance` that
 * from the hit to the light. */
static int is_shadowed(const WORLD *world, ct_pixel *pixel, const RAY *ray, const HIT *hit,
                       size_t j, VEC light, VEC to_light, REAL distance) {
  REAL zero = from_double(0), limit;
  VEC origin = offset_origin(world, ray, hit, to_light, 1), direction = to_light;
  if (world->choice[CT_OFFSET] == CT_OFFSET_DIRECTION) {
    limit = sub(distance, world->epsilon);
  } else {
    VEC way = v_sub(light, origin);
    limit = v_length(way);
    if (!less(zero, limit)) return 0;
    direction = v_over(way, limit);
    if (world->choice[CT_OFFSET] == CT_OFFSET_MITSUBA)
      limit = mul(limit, from_double(1 - MITSUBA_SHADOW_EPSILON));
  }
  int light_counts = world->choice[CT_SHADOW_DISTANCE] == CT_SHADOW_DISTANCE_LIGHT;
  if (light_counts && !less(zero, limit)) return 0; /* a light within epsilon of the hit */
  int at_light = light_counts && world->choice[CT_OFFSET] != CT_OFFSET_MITSUBA;
  pixel->n_shadow++;
  if (ct_pixel_must_stop(pixel, ray->depth)) return 0;
  for (size_t i = 0; i < world->view->n_objects; i++) {
    if (world->choice[CT_GLASS_SHADOW] == CT_GLASS_SHADOW_CLEAR &&
        world->view->material[i * CT_MATERIAL_COLUMNS + CT_KT] > 0)
      continue;
    if (at_light && ct_light_is_on(world->frame, j, i)) {
      if (blocks_own_light(world, i, origin, direction, limit)) return 1;
      continue;
    }
    REAL t = object_nearest(world, i, origin, direction, 0, world->shadow_min);
    if (!less(zero, t) || (world->has_far && less(world->far, t))) continue;
    if (!light_counts || less(t, limit)) return 1;
    if (world->choice[CT_OFFSET] == CT_OFFSET_MITSUBA && !less(limit, t)) return 1;
  }
  return 0;
}

/* ---- The illumination of a hit by the point lights (specification 3.2) ---- */

static void add_lights(const WORLD *world, ct_pixel *pixel, const RAY *ray, const HIT *hit,
                       const double *m, VEC color, SPLIT *split, uint64_t *tree) {
  const ct_scene_view *view = world->view;
  size_t i = (size_t)hit->object;
  REAL zero = from_double(0), byte = from_double(255);
  int is_diffuse = (world->effects & CT_DIFFUSE) && m[CT_KD] > 0;
  int is_specular = (world->effects & CT_SPECULAR) && m[CT_KS] > 0;
  VEC n = hit->normal, wo = v_neg(ray->direction);
  if (!is_diffuse && !is_specular) return;
  if (view->kind[i] == CT_PLANE && world->choice[CT_PLANE_NORMAL] == CT_PLANE_NORMAL_RAW)
    n = v_load(view->geometry + i * CT_GEOMETRY_COLUMNS + 3);
  if (world->choice[CT_LIGHTING_NORMAL] == CT_LIGHTING_NORMAL_FACING &&
      !less(zero, v_dot(hit->normal, wo)))
    n = v_neg(n);
  if (world->choice[CT_VIEW] == CT_VIEW_EYE && !ray->primary) {
    VEC to_eye = v_sub(world->eye, hit->point);
    wo = v_over(to_eye, v_length(to_eye));
  }
  VEC diffuse = v_scale(from_double(m[CT_KD]), color);
  for (size_t j = 0; j < view->n_lights; j++) {
    const double *light = view->lights + j * CT_LIGHT_COLUMNS;
    VEC at = v_load(light + 3), way = v_sub(at, hit->point);
    REAL distance = v_length(way);
    if (!less(zero, distance)) continue; /* the light is the hit: no direction to it */
    VEC l = v_over(way, distance);
    REAL cosine = v_dot(n, l), shine = zero;
    if (is_specular && (less(zero, cosine) || world->choice[CT_SPECULAR_GATE] == 0)) {
      VEC mirrored = v_sub(v_scale(mul(from_double(2), cosine), n), l);
      shine = highlight(mirrored, wo, m[CT_ETA]);
    }
    int lit = is_diffuse && less(zero, cosine);
    if (!lit && !less(zero, shine)) continue;
    if ((world->effects & CT_SHADOWS) &&
        is_shadowed(world, pixel, ray, hit, j, at, l, distance)) {
      *tree = ct_tree_mix(*tree, j + 1);
      continue;
    }
    VEC c = v_over(v_load(light), byte);
    if (lit) split->diffuse = v_add(split->diffuse, v_mul(v_scale(cosine, diffuse), c));
    if (less(zero, shine))
      split->specular =
          v_add(split->specular, v_scale(mul(from_double(m[CT_KS]), shine), c));
  }
}

/* ---- Secondary rays (specification 4.1, 4.2) ---- */

/* What a hit does with light that arrives along its secondary rays. */
typedef struct FN(scatter) {
  VEC mirrored, refracted;
  REAL kr, kt;
  int total, inside;
  const ct_medium *medium;
} FN(scatter);
#define SCATTER FN(scatter)

/* The index seen by a ray that crosses into or out of the object, under the readings. */
static INDEX seen_index(const WORLD *world, const RAY *ray, size_t object, int inside,
                       ct_medium *entered, const ct_medium **medium) {
  const double *m = world->view->material + object * CT_MATERIAL_COLUMNS;
  REAL one = from_double(1), n = from_double(m[CT_N]);
  int side = world->choice[CT_SIDE];
  if (world->choice[CT_NESTING] == CT_NESTING_TRACKED) {
    *entered = (ct_medium){ray->medium, object, inside ? -1 : 1};
    *medium = entered;
    return (INDEX){from_double(ct_medium_index(world->view, *medium)),
                   from_double(ct_medium_index(world->view, ray->medium))};
  }
  int is_inverse = side == CT_SIDE_INVERTED ? !inside : inside && side != CT_SIDE_ONE_WAY;
  return is_inverse ? (INDEX){one, n} : (INDEX){n, one};
}

static SCATTER scatter_at(const WORLD *world, const RAY *ray, const HIT *hit, const double *m,
                          ct_medium *entered) {
  REAL zero = from_double(0), one = from_double(1);
  VEC wo = v_neg(ray->direction);
  REAL cosine = v_dot(hit->normal, wo);
  SCATTER s = {.kr = zero, .kt = zero, .medium = ray->medium};
  s.inside = !less(zero, cosine);
  VEC facing = s.inside ? v_neg(hit->normal) : hit->normal;
  if (s.inside) cosine = neg(cosine);
  s.mirrored = v_sub(v_scale(mul(from_double(2), cosine), facing), wo);

  int tir = world->choice[CT_TIR];
  int reflects = m[CT_KR] > 0 && (world->effects & CT_REFLECTION);
  if (s.inside && m[CT_KT] > 0 && world->choice[CT_INNER_REFLECTION] == CT_INNER_REFLECTION_OFF)
    reflects = 0;
  if (reflects) s.kr = from_double(m[CT_KR]);
  if (!(m[CT_KT] > 0 || (tir == CT_TIR_ALWAYS && m[CT_N] > 0))) return s;

  INDEX index = seen_index(world, ray, (size_t)hit->object, s.inside, entered, &s.medium);
  if (refract(wo, facing, cosine, index, &s.refracted)) {
    if (world->effects & CT_REFRACTION) s.kt = from_double(m[CT_KT]);
    return s;
  }
  s.total = 1;
  if (!(world->effects & CT_TOTAL_REFLECTION)) return s;
  switch (tir) {
    case CT_TIR_IGNORE: s.total = 0; break;
    case CT_TIR_ADD: s.kr = add(s.kr, from_double(m[CT_KT])); break;
    case CT_TIR_PLUS_ONE: s.kr = add(s.kr, one); break;
    case CT_TIR_NEEDS_KR:
      if (m[CT_KR] > 0)
        s.kr = one;
      else
        s.total = 0;
      break;
    default: s.kr = one;
  }
  return s;
}

static VEC background(const WORLD *world) {
  return v_over(v_load(world->view->background), from_double(255));
}

static VEC secondary(const WORLD *world, ct_pixel *pixel, const RAY *ray, const HIT *hit,
                     VEC direction, const ct_medium *medium, uint64_t *tree) {
  if (ray->depth >= world->frame->max_depth) {
    if (world->choice[CT_EXHAUSTED] == CT_EXHAUSTED_BACKGROUND) return background(world);
    return v_zero();
  }
  /* Of length 1 but for rounding, which would grow from bounce to bounce inside glass. */
  direction = v_over(direction, v_length(direction));
  RAY next = {offset_origin(world, ray, hit, direction, 0), direction, ray->depth + 1, 0, medium};
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
  if (world->choice[CT_MIX] == CT_MIX_CONVEX) {
    REAL rest = sub(sub(from_double(1), s.kr), s.kt);
    split->base = v_scale(rest, split->base);
    split->diffuse = v_scale(rest, split->diffuse);
    split->specular = v_scale(rest, split->specular);
  }
  VEC sum = v_add(v_add(split->base, split->diffuse), split->specular);
  *tree = ct_tree_mix(*tree, (uint64_t)(s.inside | s.total << 1));
  REAL zero = from_double(0);
  if (less(zero, s.kr)) {
    if (ray->depth < world->frame->max_depth) pixel->n_reflected++;
    VEC c = v_scale(s.kr, secondary(world, pixel, ray, hit, s.mirrored, ray->medium, tree));
    *(s.total ? &split->total_reflection : &split->reflection) = c;
    sum = v_add(sum, c);
  }
  if (less(zero, s.kt)) {
    if (ray->depth < world->frame->max_depth) pixel->n_refracted++;
    split->refraction =
        v_scale(s.kt, secondary(world, pixel, ray, hit, s.refracted, s.medium, tree));
    sum = v_add(sum, split->refraction);
  }
  return sum;
}

static VEC FN(trace)(const WORLD *world, ct_pixel *pixel, const RAY *ray, SPLIT *split,
                     uint64_t *tree) {
  SPLIT own = {v_zero(), v_zero(), v_zero(), v_zero(), v_zero(), v_zero()};
  if (ct_pixel_must_stop(pixel, ray->depth)) return v_zero();
  HIT hit = FN(nearest)(world, ray);
  *tree = ct_tree_mix(*tree, (uint64_t)(hit.object + 2));
  VEC color;
  if (hit.object >= 0)
    color = shade(world, pixel, ray, &hit, &own, tree);
  else if (ray->primary || world->choice[CT_MISS] == CT_MISS_BACKGROUND)
    color = own.base = background(world);
  else
    color = v_zero();
  if (split) *split = own;
  return limit_returned(world, color);
}
