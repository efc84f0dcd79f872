/* The bounds of prune.h, worked out once a frame in double, rounded generously upwards. */
#include "prune.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "kernel.h"

/* Local light and weight of the secondary rays of some objects. */
typedef struct line {
  double local, weight;
} line;

/* Objects of one channel that are not below another in both. Of more, the last covers the rest. */
enum { MOST_LINES = 16 };
typedef struct envelope {
  line lines[MOST_LINES];
  size_t n;
} envelope;

static void cover(envelope *e, line added) {
  size_t kept = 0;
  for (size_t i = 0; i < e->n; i++) {
    line old = e->lines[i];
    if (old.local >= added.local && old.weight >= added.weight) return;
    if (old.local > added.local || old.weight > added.weight) e->lines[kept++] = old;
  }
  e->n = kept;
  if (e->n < MOST_LINES) {
    e->lines[e->n++] = added;
    return;
  }
  line *last = e->lines + MOST_LINES - 1;
  last->local = fmax(last->local, added.local);
  last->weight = fmax(last->weight, added.weight);
}

static double highest(const envelope *e, double returned) {
  double most = 0;
  for (size_t i = 0; i < e->n; i++) {
    /* Where nothing weighs anything, not even infinity counts. */
    line it = e->lines[i];
    most = fmax(most, it.weight > 0 ? it.local + it.weight * returned : it.local);
  }
  return most;
}

static double weight_of(const ct_frame *frame, const double *m) {
  unsigned effects = frame->options->effects;
  double weight = 0;
  if (effects & CT_REFLECTION) weight += m[CT_KR];
  if (effects & CT_REFRACTION) weight += m[CT_KT];
  if (!(effects & CT_TOTAL_REFLECTION)) return weight;
  /* The other readings of total reflection add 1 to kr, at most. */
  if (frame->options->choice[CT_TIR] != CT_TIR_REPLACE) return weight + 1;
  return m[CT_KT] > 0 ? fmax(weight, 1) : weight;
}

static double local_of(const ct_frame *frame, size_t i, int channel, double lights, double unit) {
  const ct_scene_view *view = &frame->view;
  const double *m = view->material + i * CT_MATERIAL_COLUMNS;
  unsigned effects = frame->options->effects;
  double color = view->color[3 * i + (size_t)channel] / 255, local = 0;
  if (effects & CT_AMBIENT) local += m[CT_KA] * color * view->ambient[channel] / 255;
  if (effects & CT_DIFFUSE) local += m[CT_KD] * color * lights;
  /* Of vectors as long as 1 but for a few roundings, and a product of eta of them. */
  if ((effects & CT_SPECULAR) && m[CT_KS] > 0)
    local += m[CT_KS] * lights * exp(20 * unit * m[CT_ETA]);
  return local;
}

static void fill(ct_reach *reach, const ct_frame *frame, double unit, size_t room) {
  const ct_scene_view *view = &frame->view;
  double none[3], returned[3], margin = 1 + 8 * unit;
  envelope envelopes[3];
  memset(envelopes, 0, sizeof envelopes);
  for (int c = 0; c < 3; c++) {
    double lights = 0;
    for (size_t j = 0; j < view->n_lights; j++)
      lights += view->lights[j * CT_LIGHT_COLUMNS + (size_t)c] / 255;
    lights *= 1 + unit * (64 + 4 * (double)view->n_lights);
    for (size_t i = 0; i < view->n_objects; i++) {
      double weight = weight_of(frame, view->material + i * CT_MATERIAL_COLUMNS);
      cover(envelopes + c, (line){local_of(frame, i, c, lights, unit) * margin, weight * margin});
    }
    none[c] = view->background[c] / 255 * margin;
    int lit = frame->options->choice[CT_EXHAUSTED] == CT_EXHAUSTED_BACKGROUND;
    returned[c] = lit ? none[c] : 0;
  }
  int clamps = frame->options->choice[CT_RECURSION] == CT_RECURSION_CLAMP;
  for (size_t r = 0; r < room; r++) {
    double most = 0;
    for (int c = 0; c < 3; c++) {
      returned[c] = fmax(none[c], highest(envelopes + c, returned[c]) * margin);
      if (clamps) returned[c] = fmin(returned[c], 1);
      most = fmax(most, returned[c]);
    }
    reach->most[r] = most;
    reach->n_bounces = r + 1;
    /* V grows from bounce to bounce until it stays. */
    if (r > 0 && !(most > reach->most[r - 1])) return;
  }
}

ct_status ct_reach_open(ct_reach *reach, const ct_frame *frame, double unit) {
  memset(reach, 0, sizeof *reach);
  const int *choice = frame->options->choice;
  if (!(frame->options->tolerance > 0) || frame->max_depth == 0) return CT_OK;
  if (choice[CT_MIX] == CT_MIX_CONVEX || choice[CT_RECURSION] == CT_RECURSION_SCALE ||
      choice[CT_NESTING] == CT_NESTING_INTERIORS ||
      choice[CT_PLANE_NORMAL] == CT_PLANE_NORMAL_RAW)
    return CT_OK;
  if (unit < DBL_EPSILON / 2) unit = DBL_EPSILON / 2;
  int64_t depth = frame->max_depth < CT_MAX_TREE_DEPTH ? frame->max_depth : CT_MAX_TREE_DEPTH;
  size_t room = (size_t)depth + 1;
  reach->most = malloc(room * sizeof *reach->most);
  if (!reach->most) return CT_ERR_MEMORY;
  fill(reach, frame, unit, room);
  double most = reach->most[reach->n_bounces - 1], rounding = 8 * unit * ((double)depth + 2);
  double slack = frame->options->tolerance * (1 - rounding) - most * rounding;
  /* Every type holds what is below this. */
  if (slack > 0 && most < 0x1p100 && depth == frame->max_depth) reach->slack = slack;
  return CT_OK;
}

void ct_reach_close(ct_reach *reach) { free(reach->most); }
