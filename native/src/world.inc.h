/* What the kernel's texts share: the world of a frame, a ray, a hit, and the terms of a pixel. */

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

#include "hooks.inc.h"
