/* What the kernel's texts share: the world of a frame, a ray, a hit, and the terms of a pixel. */
#include "bvh_walk.h"

#include "prune.h"

typedef struct FN(world) {
  const ct_frame *frame;
  const ct_scene_view *view;
  const int *choice;
  unsigned effects;
  VEC *plane_normal; /* unit, in this type */
  VEC u, v, w, eye;
  REAL epsilon, shadow_min, light_min, far;
  int has_far;
  ct_reach reach;
} FN(world);
#define WORLD FN(world)

typedef struct FN(ray) {
  VEC origin, direction; /* direction of length 1 */
  int64_t depth;
  int primary;
  const ct_medium *medium; /* nesting=tracked only */
  REAL slack; /* how much less may return: prune.h */
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

/* Where rounding is under test it may also decide which of two surfaces that meet comes first. */
#ifdef CT_PERTURBED
static REAL nudged_distance(const WORLD *world, ct_pixel *pixel, const RAY *ray, size_t i, REAL t);
#else
#define nudged_distance(world, pixel, ray, i, t) ((void)(pixel), (t))
#endif

/* What walks allow for beside their own errors: the kernel's rounding, which counts in float alone,
 * and directions that are not of length 1 (perturb.inc.h). */
#ifdef CT_PERTURBED
#define REAL_SLACK 0x1p-16 /* for the errors of float32, the largest that are tried */
#else
#define REAL_SLACK (REAL_DIGITS < 53 ? 0x1p-16 : 0)
#endif

static inline double walk_slack(VEC direction) {
  return REAL_SLACK + 64 * fabs(to_double(v_dot(direction, direction)) - 1);
}

static void walk_along(const WORLD *world, VEC origin, VEC direction, ct_walk *walk) {
  double o[3], d[3];
  v_store(origin, o);
  v_store(direction, d);
  ct_walk_start(walk, world->frame->bvh, o, o, d, d, walk_slack(direction));
}

/* Makes object i the hit if it is. */
static inline void offer_object(const WORLD *world, ct_pixel *pixel, const RAY *ray, size_t i,
                                HIT *hit) {
  REAL zero = from_double(0);
  REAL t = object_nearest(world, i, ray->origin, ray->direction, ray->primary, zero);
  if (!less(zero, t) || (world->has_far && less(world->far, t))) return;
  t = nudged_distance(world, pixel, ray, i, t);
  if (hit->object >= 0 && !less(t, hit->t)) {
    /* A tie stays with the first in the file. */
    if (less(hit->t, t) || (int64_t)i > hit->object) return;
  }
  hit->object = (int64_t)i;
  hit->t = t;
}

/* Of its own, so that the walk's stack does not lie in every level of the recursion. */
static __attribute__((noinline)) void offer_tree(const WORLD *world, ct_pixel *pixel, const RAY *ray,
                                                 HIT *hit) {
  const ct_bvh *bvh = world->frame->bvh;
  ct_walk walk;
  size_t first;
  unsigned n;
  for (size_t k = 0; k < bvh->n_apart; k++) offer_object(world, pixel, ray, bvh->apart[k], hit);
  walk_along(world, ray->origin, ray->direction, &walk);
  float before = ct_walk_before(hit->object >= 0 ? to_double(hit->t) : (double)INFINITY);
  while (ct_walk_next_on_ray(&walk, before, &first, &n)) {
    for (size_t k = first; k < first + n; k++) offer_object(world, pixel, ray, bvh->object[k], hit);
    if (hit->object >= 0) before = ct_walk_before(to_double(hit->t));
  }
}

static HIT FN(nearest)(const WORLD *world, ct_pixel *pixel, const RAY *ray) {
  HIT hit = {.object = -1};
  if (world->frame->bvh)
    offer_tree(world, pixel, ray, &hit);
  else
    for (size_t i = 0; i < world->view->n_objects; i++) offer_object(world, pixel, ray, i, &hit);
  if (hit.object >= 0) {
    hit.point = v_along(ray->origin, hit.t, ray->direction);
    hit.normal = object_normal(world, (size_t)hit.object, hit.point);
  }
  return hit;
}

#include "hooks.inc.h"
