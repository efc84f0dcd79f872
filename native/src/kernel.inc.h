/* The tracing kernel of one precision. The includer defines the scalar type (real_*.h), picks the
 * primitives (CT_PRIMITIVES), names the kernel (CT_RUNG), says how much stack one level of its
 * recursion needs (CT_STACK_PER_LEVEL) and whether it may run in any rounding mode
 * (CT_TAKES_ROUNDING); this text defines FN(ct_kernel). CT_PERTURBED makes it the kernel that moves
 * directions and hits by random errors; elsewhere those places cost nothing.
 */
#include <stdlib.h>

#include "sample_point.h"
#include "vector.inc.h"
#include "power.inc.h"
#include CT_PRIMITIVES
#include "world.inc.h"
#ifdef CT_PERTURBED
#include "perturb.inc.h"
#else
#define NUDGED(pixel, direction) ((void)(pixel), (direction))
#define NUDGED_ORIGIN(pixel, origin) (origin)
#define IS_NUDGED(pixel) 0
#define NUDGE_HIT(world, pixel, ray, hit) ((void)0)
#endif
#include "light.inc.h"
#include "scatter.inc.h"
#include "prune.inc.h"
#include "trace.inc.h"

static ct_status FN(open)(const ct_frame *frame, void **out) {
  WORLD *world = calloc(1, sizeof *world);
  if (!world) return CT_ERR_MEMORY;
  world->plane_normal = malloc((frame->n_planes + 1) * sizeof *world->plane_normal);
  if (!world->plane_normal) {
    free(world);
    return CT_ERR_MEMORY;
  }
  if (ct_reach_open(&world->reach, frame, REAL_UNIT) != CT_OK) {
    free(world->plane_normal);
    free(world);
    return CT_ERR_MEMORY;
  }
  for (size_t i = 0; i < frame->n_planes; i++)
    world->plane_normal[i] = v_load_wide(frame->plane_normal + 3 * i);
  world->frame = frame;
  world->view = &frame->view;
  world->choice = frame->options->choice;
  world->effects = frame->options->effects;
  world->u = v_load_wide(frame->u);
  world->v = v_load_wide(frame->v);
  world->w = v_load_wide(frame->w);
  world->eye = v_load(frame->view.eye);
  int twice = frame->options->choice[CT_EPSILON_TWICE];
  world->epsilon = mul(from_double(twice ? 2 : 1), from_double(frame->options->epsilon));
  world->shadow_min = from_double(frame->options->shadow_min);
  world->light_min = from_double(frame->options->light_min);
  world->far = from_double(frame->options->far);
  world->has_far = frame->options->far > 0;
  *out = world;
  return CT_OK;
}

static void FN(close)(void *opaque) {
  WORLD *world = opaque;
  free(world->plane_normal);
  ct_reach_close(&world->reach);
  free(world);
}

/* The ray through the centre of pixel (row, column) (specification 2.3), or a point near it. */
static RAY FN(primary)(const WORLD *world, ct_pixel *pixel, int64_t row, int64_t column) {
  const ct_scene_view *v = world->view;
  REAL s = from_double(v->pixel_size);
  double right, below;
  ct_sample_point(world->frame, row, column, &right, &below);
  REAL x = mul(s, from_double(right)), y = neg(mul(s, from_double(below)));
  VEC way = v_sub(v_add(v_scale(x, world->u), v_scale(y, world->v)),
                  v_scale(from_double(v->screen_distance), world->w));
  RAY ray = {world->eye, NUDGED(pixel, v_over(way, v_length(way))), 0, 1, NULL,
             from_double(world->reach.slack)};
  if (world->choice[CT_OFFSET] == CT_OFFSET_MITSUBA) {
    REAL forward = neg(v_dot(ray.direction, world->w));
    ray.origin = v_along(ray.origin, quo(from_double(MITSUBA_NEAR), forward), ray.direction);
  }
  return ray;
}

static void FN(pixel)(const void *opaque, int64_t row, int64_t column, ct_pixel *pixel) {
  const WORLD *world = opaque;
  RAY ray = FN(primary)(world, pixel, row, column);
  SPLIT split;
  ray.medium = world->frame->eye_medium;
  VEC color = FN(trace)(world, pixel, &ray, &split, &pixel->tree);
  v_store(color, pixel->color);
  v_store_low(color, pixel->color_low);
  if (pixel->wants_contributions) {
    v_store(split.base, pixel->contributions);
    v_store(split.diffuse, pixel->contributions + 3);
    v_store(split.specular, pixel->contributions + 6);
    v_store(split.reflection, pixel->contributions + 9);
    v_store(split.refraction, pixel->contributions + 12);
    v_store(split.total_reflection, pixel->contributions + 15);
  }
  if (pixel->wants_hit) {
    HIT hit = FN(nearest)(world, pixel, &ray);
    pixel->object = (int32_t)hit.object;
    pixel->t_world = hit.object >= 0 ? to_double(hit.t) : (double)INFINITY;
    v_store(hit.object >= 0 ? hit.normal : v_zero(), pixel->normal);
  }
}

static void FN(nearest_to)(const void *opaque, const double origin[3], const double direction[3],
                           double *t, int64_t *object) {
  RAY ray = {.origin = v_load(origin), .direction = v_load(direction)};
  ct_pixel pixel = {0};
  HIT hit = FN(nearest)(opaque, &pixel, &ray);
  *object = hit.object;
  *t = hit.object >= 0 ? to_double(hit.t) : (double)INFINITY;
}

const ct_kernel FN(ct_kernel) = {CT_RUNG,   CT_STACK_PER_LEVEL, CT_TAKES_ROUNDING, FN(open),
                                 FN(close), FN(pixel),          FN(nearest_to)};
