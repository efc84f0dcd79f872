/* Where rays leave a surface, what stands before a light, and the light of the specification's 3.2. */

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

/* Where a light lies on a sphere, one root is the light itself, at `reach`, and the other 2b minus
 * it. */
static int blocks_own_light(const WORLD *world, size_t i, VEC origin, VEC direction, REAL reach,
                            REAL limit) {
  const double *g = world->view->geometry + i * CT_GEOMETRY_COLUMNS;
  if (world->view->kind[i] == CT_PLANE) return 0;
  REAL b = neg(v_dot(v_sub(origin, v_load(g)), direction));
  REAL other = sub(mul(from_double(2), b), reach);
  return less(world->shadow_min, other) && less(other, limit);
}

/* A ray on its way to a light. */
typedef struct FN(feeler) {
  VEC origin, direction;
  REAL reach, limit; /* how far the light is; blockers stand nearer than this */
  int light_counts, at_light; /* the limit is one; a light on a surface is not behind it */
} FN(feeler);
#define FEELER FN(feeler)

/* Does object i stand between a hit and light j? */
static inline int is_blocked_by(const WORLD *world, size_t i, size_t j, const FEELER *f) {
  REAL zero = from_double(0);
  if (world->choice[CT_GLASS_SHADOW] == CT_GLASS_SHADOW_CLEAR &&
      world->view->material[i * CT_MATERIAL_COLUMNS + CT_KT] > 0)
    return 0;
  if (f->at_light && ct_light_is_on(world->frame, j, i))
    return blocks_own_light(world, i, f->origin, f->direction, f->reach, f->limit);
  REAL t = object_nearest(world, i, f->origin, f->direction, 0, world->shadow_min);
  if (!less(zero, t) || (world->has_far && less(world->far, t))) return 0;
  if (!f->light_counts || less(t, f->limit)) return 1;
  return world->choice[CT_OFFSET] == CT_OFFSET_MITSUBA && !less(f->limit, t);
}

static __attribute__((noinline)) int is_blocked_in_tree(const WORLD *world, size_t j,
                                                        const FEELER *f) {
  const ct_bvh *bvh = world->frame->bvh;
  ct_walk walk;
  size_t first;
  unsigned n;
  for (size_t k = 0; k < bvh->n_apart; k++)
    if (is_blocked_by(world, bvh->apart[k], j, f)) return 1;
  walk_along(world, f->origin, f->direction, &walk);
  float before = ct_walk_before(f->light_counts ? to_double(f->limit) : (double)INFINITY);
  while (ct_walk_next_on_ray(&walk, before, &first, &n))
    for (size_t k = first; k < first + n; k++)
      if (is_blocked_by(world, bvh->object[k], j, f)) return 1;
  return 0;
}

/* Does any object stand between the hit and light j? `to_light` is of length 1, `distance` that
 * from the hit to the light. */
static int is_shadowed(const WORLD *world, ct_pixel *pixel, const RAY *ray, const HIT *hit,
                       size_t j, VEC light, VEC to_light, REAL distance) {
  REAL zero = from_double(0), reach; /* from where the ray starts to the light */
  VEC origin = NUDGED_ORIGIN(pixel, offset_origin(world, ray, hit, to_light, 1));
  VEC direction = to_light;
  if (world->choice[CT_OFFSET] == CT_OFFSET_DIRECTION) {
    reach = sub(distance, world->epsilon);
  } else {
    VEC way = v_sub(light, origin);
    reach = v_length(way);
    if (!less(zero, reach)) return 0;
    direction = NUDGED(pixel, v_over(way, reach));
  }
  REAL limit = sub(reach, world->light_min); /* blockers stand nearer than this */
  if (world->choice[CT_OFFSET] == CT_OFFSET_MITSUBA) {
    REAL shortened = mul(reach, from_double(1 - MITSUBA_SHADOW_EPSILON));
    if (less(shortened, limit)) limit = shortened;
  }
  int light_counts = world->choice[CT_SHADOW_DISTANCE] == CT_SHADOW_DISTANCE_LIGHT;
  if (light_counts && !less(zero, limit)) return 0; /* a light within epsilon of the hit */
  int at_light = light_counts && world->choice[CT_OFFSET] != CT_OFFSET_MITSUBA;
  pixel->n_shadow++;
  if (ct_pixel_must_stop(pixel, ray->depth)) return 0;
  ON_FEELER(world, pixel, ray, hit, j, origin, direction, limit);
  FEELER feeler = {origin, direction, reach, limit, light_counts, at_light && !IS_NUDGED(pixel)};
  if (world->frame->bvh) return is_blocked_in_tree(world, j, &feeler);
  for (size_t i = 0; i < world->view->n_objects; i++)
    if (is_blocked_by(world, i, j, &feeler)) return 1;
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
    VEC l = NUDGED(pixel, v_over(way, distance));
    REAL cosine = v_dot(n, l), shine = zero;
    if (is_specular && (less(zero, cosine) || world->choice[CT_SPECULAR_GATE] == 0)) {
      VEC mirrored = v_sub(v_scale(mul(from_double(2), cosine), n), l);
      shine = highlight(mirrored, wo, m[CT_ETA]);
    }
    int lit = is_diffuse && less(zero, cosine);
    ON_LIGHT(world, pixel, hit, j, cosine, lit, diffuse, is_specular, shine);
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
