/* Builds the tree top down: the children of a node are made by splitting the largest of the ranges
 * so far, until there are eight or none is worth it. A range is split where the surface area
 * heuristic says so, in bins of its centres along each axis (Wald 2007); where all centres are in
 * one bin, or too deep down, in the middle of its list. Time n log n; 32 bytes an object while it
 * builds. */
#include "bvh.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Coordinates and radii within which squares in float and distances in the walk are finite. */
#define LARGEST 1e15
#define SMALLEST 1e-15

enum { N_BINS = 16, MOST_OUTLIERS = 16, HALVE_BELOW = 30 };
/* A sphere that reaches this many times farther than all but a few others is kept apart. */
#define OUT_OF_PROPORTION 64

typedef struct box {
  float low[4], high[4]; /* the last of each only fills up */
} box;

/* An object on its way into a leaf: its box, and its index in the bits of low[3]. */
typedef struct item {
  float low[3];
  uint32_t object;
  float high[3], unused;
} item;

typedef struct range {
  size_t begin, end;
  box around;
} range;

typedef struct builder {
  ct_bvh *bvh;
  item *items;
  size_t room; /* for nodes */
  const atomic_int *stop;
} builder;

static const box nothing = {{INFINITY, INFINITY, INFINITY, 0}, {-INFINITY, -INFINITY, -INFINITY, 0}};

static inline void take_item(box *b, const item *a) {
  for (int k = 0; k < 3; k++) {
    b->low[k] = a->low[k] < b->low[k] ? a->low[k] : b->low[k];
    b->high[k] = a->high[k] > b->high[k] ? a->high[k] : b->high[k];
  }
}

static inline void take_box(box *b, const box *a) {
  for (int k = 0; k < 3; k++) {
    b->low[k] = a->low[k] < b->low[k] ? a->low[k] : b->low[k];
    b->high[k] = a->high[k] > b->high[k] ? a->high[k] : b->high[k];
  }
}

/* Half the surface. */
static double area_of(const box *b) {
  double side[3];
  for (int k = 0; k < 3; k++) side[k] = (double)b->high[k] - (double)b->low[k];
  return side[0] * side[1] + side[1] * side[2] + side[2] * side[0];
}

/* Twice the centre. */
static inline float center_of(const item *a, int axis) { return a->low[axis] + a->high[axis]; }

typedef struct bin {
  box around;
  size_t n;
} bin;

typedef struct plan {
  int axis, first_right; /* bins from this one on go right; axis -1: none is any good */
  float from, scale;
} plan;

static inline int bin_of(const item *a, int axis, float from, float scale) {
  int k = (int)((center_of(a, axis) - from) * scale);
  return k < 0 ? 0 : k >= N_BINS ? N_BINS - 1 : k;
}

/* The best place to cut along one axis, if it beats `least`. */
static void weigh_cuts(const bin bins[N_BINS], int axis, double *least, plan *best) {
  double right_cost[N_BINS];
  box side = nothing;
  size_t n = 0;
  for (int k = N_BINS - 1; k > 0; k--) {
    take_box(&side, &bins[k].around);
    n += bins[k].n;
    right_cost[k] = n ? (double)n * area_of(&side) : 0;
  }
  side = nothing;
  n = 0;
  for (int k = 1; k < N_BINS; k++) {
    take_box(&side, &bins[k - 1].around);
    n += bins[k - 1].n;
    if (n == 0) continue;
    double cost = (double)n * area_of(&side) + right_cost[k];
    if (right_cost[k] > 0 && cost < *least) {
      *least = cost;
      best->axis = axis;
      best->first_right = k;
    }
  }
}

static plan plan_cut(const builder *b, const range *r) {
  float low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
  for (size_t i = r->begin; i < r->end; i++)
    for (int k = 0; k < 3; k++) {
      float c = center_of(b->items + i, k);
      low[k] = c < low[k] ? c : low[k];
      high[k] = c > high[k] ? c : high[k];
    }
  bin bins[3][N_BINS];
  float scale[3];
  for (int k = 0; k < 3; k++) {
    scale[k] = high[k] > low[k] ? (float)N_BINS * 0.9999f / (high[k] - low[k]) : 0;
    if (!(scale[k] < FLT_MAX)) scale[k] = 0;
    for (int j = 0; j < N_BINS; j++) bins[k][j] = (bin){nothing, 0};
  }
  for (size_t i = r->begin; i < r->end; i++)
    for (int k = 0; k < 3; k++) {
      bin *at = &bins[k][bin_of(b->items + i, k, low[k], scale[k])];
      take_item(&at->around, b->items + i);
      at->n++;
    }
  plan best = {.axis = -1};
  double least = (double)INFINITY;
  for (int k = 0; k < 3; k++)
    if (scale[k] > 0) weigh_cuts(bins[k], k, &least, &best);
  if (best.axis >= 0) {
    best.from = low[best.axis];
    best.scale = scale[best.axis];
  }
  return best;
}

static void set_box(const builder *b, range *r) {
  r->around = nothing;
  for (size_t i = r->begin; i < r->end; i++) take_item(&r->around, b->items + i);
}

/* Cuts a range in two: *r keeps the left part. */
static range cut(builder *b, range *r, int depth) {
  size_t middle = r->begin + (r->end - r->begin) / 2;
  plan p = {.axis = -1};
  if (depth < HALVE_BELOW) p = plan_cut(b, r);
  if (p.axis >= 0) {
    size_t left = r->begin, right = r->end;
    while (left < right) {
      if (bin_of(b->items + left, p.axis, p.from, p.scale) < p.first_right) {
        left++;
        continue;
      }
      item other = b->items[--right];
      b->items[right] = b->items[left];
      b->items[left] = other;
    }
    middle = left;
  }
  range rest = {.begin = middle, .end = r->end};
  r->end = middle;
  set_box(b, r);
  set_box(b, &rest);
  return rest;
}

static ct_status new_node(builder *b, size_t *index) {
  ct_bvh *bvh = b->bvh;
  if (bvh->n_nodes == b->room) {
    b->room = b->room + b->room / 2 + 64;
    void *more = realloc(bvh->nodes, b->room * sizeof *bvh->nodes);
    if (!more) return CT_ERR_MEMORY;
    bvh->nodes = more;
  }
  *index = bvh->n_nodes++;
  return CT_OK;
}

/* The range that is the most worth cutting; -1: none. */
static int largest(const range *ranges, int n) {
  int found = -1;
  double most = -1;
  for (int k = 0; k < n; k++) {
    size_t count = ranges[k].end - ranges[k].begin;
    if (count <= CT_BVH_LEAF) continue;
    double area = area_of(&ranges[k].around);
    if (area > most) most = area, found = k;
  }
  return found;
}

static ct_status build(builder *b, const range *whole, int depth, size_t *index) {
  range parts[CT_BVH_WIDTH] = {*whole};
  int n = 1, k;
  while (n < CT_BVH_WIDTH && (k = largest(parts, n)) >= 0) {
    int stop = atomic_load_explicit(b->stop, memory_order_relaxed);
    if (stop) return (ct_status)stop;
    parts[n] = cut(b, &parts[k], depth);
    n++;
  }
  ct_status status = new_node(b, index);
  if (status) return status;
  uint32_t child[CT_BVH_WIDTH] = {0};
  for (int j = 0; j < n; j++) {
    size_t count = parts[j].end - parts[j].begin, below = 0;
    if (count <= CT_BVH_LEAF) {
      child[j] = CT_BVH_IS_LEAF | (uint32_t)(count - 1) << CT_BVH_COUNT_SHIFT |
                 (uint32_t)parts[j].begin;
      continue;
    }
    if ((status = build(b, &parts[j], depth + 1, &below)) != CT_OK) return status;
    child[j] = (uint32_t)below;
  }
  ct_bvh_node *node = b->bvh->nodes + *index; /* which building the children may have moved */
  memcpy(node->child, child, sizeof child);
  for (int j = 0; j < CT_BVH_WIDTH; j++)
    for (int axis = 0; axis < 3; axis++) {
      node->bound[axis][j] = j < n ? parts[j].around.low[axis] : INFINITY;
      node->bound[3 + axis][j] = j < n ? parts[j].around.high[axis] : -INFINITY;
    }
  return CT_OK;
}

/* How far a sphere reaches from the world's origin along an axis. */
static double reach_of(const double *g) {
  return fmax(fabs(g[0]), fmax(fabs(g[1]), fabs(g[2]))) + g[3];
}

/* The reach beyond which spheres are out of proportion. */
static double proportion(const ct_scene_view *view, const uint8_t *is_apart) {
  double most[MOST_OUTLIERS + 1] = {0}; /* the largest, in falling order */
  for (size_t i = 0; i < view->n_objects; i++) {
    if (view->kind[i] != CT_SPHERE || is_apart[i]) continue;
    double reach = reach_of(view->geometry + i * CT_GEOMETRY_COLUMNS);
    if (!(reach > most[MOST_OUTLIERS])) continue;
    int k = MOST_OUTLIERS;
    for (; k > 0 && reach > most[k - 1]; k--) most[k] = most[k - 1];
    most[k] = reach;
  }
  size_t few = view->n_objects / 2;
  return OUT_OF_PROPORTION * most[few < MOST_OUTLIERS ? few : MOST_OUTLIERS];
}

static int is_inside(const ct_scene_view *view, const uint8_t *is_apart, size_t i, double most) {
  const double *g = view->geometry + i * CT_GEOMETRY_COLUMNS;
  return view->kind[i] == CT_SPHERE && !is_apart[i] && g[3] >= SMALLEST && reach_of(g) <= most;
}

/* Rounding to float errs by 2^-24 at most, so this is outward. */
static float below(double x) { return (float)(x - fabs(x) * 0x1p-23 - 0x1p-120); }
static float above(double x) { return (float)(x + fabs(x) * 0x1p-23 + 0x1p-120); }

static void place(ct_bvh *bvh, const ct_scene_view *view, const uint8_t *is_apart, double most,
                  item *items) {
  double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
  bvh->least_radius = (double)INFINITY;
  for (size_t i = 0; i < view->n_objects; i++) {
    const double *g = view->geometry + i * CT_GEOMETRY_COLUMNS;
    if (!is_inside(view, is_apart, i, most)) {
      bvh->apart[bvh->n_apart++] = (uint32_t)i;
      continue;
    }
    items[bvh->n_objects++].object = (uint32_t)i;
    bvh->extent = fmax(bvh->extent, reach_of(g));
    bvh->least_radius = fmin(bvh->least_radius, g[3]);
    for (int k = 0; k < 3; k++) {
      low[k] = fmin(low[k], g[k] - g[3]);
      high[k] = fmax(high[k], g[k] + g[3]);
    }
  }
  for (int k = 0; k < 3; k++) {
    bvh->middle[k] = 0.5 * (low[k] + high[k]);
    bvh->reach = fmax(bvh->reach, 0.5 * (high[k] - low[k]));
  }
  for (size_t j = 0; j < bvh->n_objects; j++) {
    const double *g = view->geometry + items[j].object * CT_GEOMETRY_COLUMNS;
    for (int k = 0; k < 3; k++) {
      items[j].low[k] = below(g[k] - g[3] - bvh->middle[k]);
      items[j].high[k] = above(g[k] + g[3] - bvh->middle[k]);
    }
  }
}

static ct_status build_tree(ct_bvh *bvh, const ct_scene_view *view, const uint8_t *is_apart,
                            double most, size_t n, const atomic_int *stop) {
  item *items = malloc(n * sizeof *items);
  if (!items) return CT_ERR_MEMORY;
  place(bvh, view, is_apart, most, items);
  builder b = {.bvh = bvh, .items = items, .stop = stop};
  range whole = {.begin = 0, .end = bvh->n_objects};
  size_t root = 0;
  set_box(&b, &whole);
  ct_status status = build(&b, &whole, 0, &root);
  if (!status) {
    bvh->object = malloc(n * sizeof *bvh->object);
    if (!bvh->object) status = CT_ERR_MEMORY;
  }
  for (size_t j = 0; !status && j < n; j++) bvh->object[j] = items[j].object;
  free(items);
  return status;
}

ct_status ct_bvh_open(const ct_scene_view *view, const uint8_t *is_apart, size_t least,
                      const atomic_int *stop, ct_bvh **out) {
  *out = NULL;
  if (view->n_objects < least || view->n_objects >= CT_BVH_MOST_OBJECTS) return CT_OK;
  double most = fmin(LARGEST, proportion(view, is_apart));
  size_t n = 0;
  for (size_t i = 0; i < view->n_objects; i++) n += (size_t)is_inside(view, is_apart, i, most);
  if (n < least || n == 0) return CT_OK;
  ct_bvh *bvh = calloc(1, sizeof *bvh);
  if (!bvh) return CT_ERR_MEMORY;
  bvh->apart = malloc((view->n_objects - n + 1) * sizeof *bvh->apart);
  ct_status status = bvh->apart ? build_tree(bvh, view, is_apart, most, n, stop) : CT_ERR_MEMORY;
  if (status) {
    ct_bvh_close(bvh);
    return status;
  }
  *out = bvh;
  return CT_OK;
}

void ct_bvh_close(ct_bvh *bvh) {
  if (!bvh) return;
  free(bvh->nodes);
  free(bvh->object);
  free(bvh->apart);
  free(bvh);
}
