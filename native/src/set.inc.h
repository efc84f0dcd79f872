/* The set-valued kernel for one type of bounds (bound_*.h): an enclosure of each pixel.
 *
 * Where a decision is open, a script says which outcome is followed; all scripts are run in turn,
 * like the digits of a counter, so the text of the recursion stays that of one path. A run whose
 * decisions are all certain is the whole answer.
 */
#include <stdlib.h>
#include <string.h>

#include "bvh_walk.h"
#include "kernel.h"
#include "set.h"
#include "interval.inc.h"
#include "set_power.inc.h"
#include "set_world.inc.h"
#include "set_filter.inc.h"
#include "set_hit.inc.h"
#include "set_light.inc.h"
#include "set_shade.inc.h"

static RAY primary_ray(const WORLD *world, int64_t row, int64_t column) {
  const ct_scene_view *v = world->view;
  IV s = i_from(v->pixel_size);
  /* Halves of integers: exact. */
  IV x = i_mul(s, i_from((double)column - (double)v->h_res / 2 + 0.5));
  IV y = i_neg(i_mul(s, i_from((double)row - (double)v->v_res / 2 + 0.5)));
  IV d = i_from(v->screen_distance);
  IV3 way = i3_sub(i3_add(i3_scale(x, world->u), i3_scale(y, world->v)), i3_scale(d, world->w));
  /* u, v, w are orthonormal, so the length needs none of their enclosures. */
  IV length = i_sqrt(i_add(i_add(i_square(x), i_square(y)), i_square(d)));
  RAY ray = {.origin = i3_from(v->eye), .primary = 1};
  ray.direction = unit_error3(world, i3_over_positive(way, length));
  if (world->choice[CT_OFFSET] == CT_OFFSET_MITSUBA) {
    IV forward = i_over_positive(d, length);
    ray.origin = i3_along(ray.origin, i_over_positive(i_from(SET_MITSUBA_NEAR), forward),
                          ray.direction);
  }
  return ray;
}

/* The next script in counting order; 0 after the last. */
static int next_script(STATE *s) {
  int n = s->n_decided;
  while (n > 0 && s->script[n - 1] + 1 >= s->n_options[n - 1]) n--;
  if (n <= 0 || n > CT_MAX_DECISIONS) return 0;
  s->script[n - 1]++;
  if (n < CT_MAX_DECISIONS) memset(s->script + n, 0, (size_t)(CT_MAX_DECISIONS - n));
  return 1;
}

static void store_outcome(IV3 c, ct_set_result *result) {
  const IV parts[3] = {c.x, c.y, c.z};
  double lo[3], hi[3];
  for (int k = 0; k < 3; k++) {
    lo[k] = -b_to_double(parts[k].nlo);
    hi[k] = b_to_double(parts[k].hi);
    if (!(lo[k] >= result->lo[k])) result->lo[k] = lo[k];
    if (!(hi[k] <= result->hi[k])) result->hi[k] = hi[k];
  }
  for (size_t i = 0; i < result->n_alternatives; i++)
    if (memcmp(result->alternatives[i][0], lo, sizeof lo) == 0 &&
        memcmp(result->alternatives[i][1], hi, sizeof hi) == 0)
      return;
  if (result->n_alternatives == CT_ALTERNATIVES) return;
  memcpy(result->alternatives[result->n_alternatives][0], lo, sizeof lo);
  memcpy(result->alternatives[result->n_alternatives++][1], hi, sizeof hi);
}

static void SET_FN(pixel)(const void *opaque, int64_t row, int64_t column,
                          const ct_set_limits *limits, ct_set_result *result) {
  STATE state = {.world = opaque, .limits = limits};
  RAY ray = primary_ray(state.world, row, column);
  ray.medium = state.world->frame->eye_medium;
  result->n_alternatives = 0;
  result->first = (ct_decision){CT_DECISION_NONE, 0, -1};
  for (int k = 0; k < 3; k++) {
    result->lo[k] = (double)INFINITY;
    result->hi[k] = -(double)INFINITY;
  }
  for (int n_outcomes = 1;; n_outcomes++) {
    state.n_decided = 0;
    IV3 color = SET_FN(trace)(&state, &ray);
    if (n_outcomes == 1 && (state.n_decided || state.status)) result->first = state.first;
    if (state.status != CT_SET_DECIDED) break;
    store_outcome(color, result);
    if (!next_script(&state)) break;
    if (n_outcomes >= limits->n_outcomes) {
      state.status = CT_SET_BUDGET;
      break;
    }
  }
  result->n_rays = state.n_rays;
  result->status = state.status != CT_SET_DECIDED ? state.status
                   : result->first.kind != CT_DECISION_NONE ? CT_SET_AMBIGUOUS
                                                            : CT_SET_DECIDED;
}

const ct_set_kernel SET_FN(ct_set_kernel_all) = {SET_NAME, SET_ROUNDING, SET_FN(open), SET_FN(close),
                                                 SET_FN(pixel)};
