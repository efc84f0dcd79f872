/* The tree of boxes finds what asking every object finds: the same bits of every output in every
 * precision, with every instruction set, under readings that move rays; and enclosures that are the
 * same or narrower. */
#include <math.h>
#include <string.h>

#include "check.h"
#include "crosstrace.h"
#include "random.h"

enum { MOST_OBJECTS = 700, N_LIGHTS = 2, SIDE = 24, N_PIXELS = SIDE * SIDE };

static uint8_t kind[MOST_OBJECTS];
static double color[MOST_OBJECTS * 3], material[MOST_OBJECTS * CT_MATERIAL_COLUMNS];
static double geometry[MOST_OBJECTS * CT_GEOMETRY_COLUMNS], lights[N_LIGHTS * CT_LIGHT_COLUMNS];

typedef struct picture {
  double image[N_PIXELS * 3], t_world[N_PIXELS], normal[N_PIXELS * 3];
  int32_t object[N_PIXELS];
  uint64_t tree[N_PIXELS];
  uint32_t rays[N_PIXELS];
} picture;
static picture scanned, found;

static int one_in(int n) { return uniform() * n < 1; }
static size_t below(size_t n) { return (size_t)(uniform() * (double)n); }

static void place_sphere(size_t i, int layout, double scale, double away) {
  double *g = geometry + i * CT_GEOMETRY_COLUMNS;
  double side = 4 * scale;
  switch (layout) {
    case 0: /* a cloud */
      for (int k = 0; k < 3; k++) g[k] = uniform_in(-side, side);
      g[3] = exponential_in(0.05, 0.6) * scale;
      break;
    case 1: /* a grid: ties, and rays that graze */
      for (int k = 0; k < 3; k++) g[k] = scale * (double)((i >> (3 * k)) % 8) - 4 * scale;
      g[3] = 0.5 * scale;
      break;
    case 2: /* clusters of tiny ones, which float can hardly tell apart */
      for (int k = 0; k < 3; k++)
        g[k] = side * (double)(i % 3) - side + uniform_in(-1e-3, 1e-3) * scale;
      g[3] = exponential_in(1e-5, 1e-1) * scale;
      break;
    case 3: /* one in another, and one place again and again */
      for (int k = 0; k < 3; k++) g[k] = 0.1 * scale * (double)(i % 5);
      g[3] = scale * (1 + (double)(i / 10) * 0.01);
      break;
    default: /* a flat layer */
      g[0] = uniform_in(-side, side);
      g[1] = uniform_in(-side, side);
      g[2] = -scale;
      g[3] = 0.2 * scale;
  }
  if (one_in(60)) g[3] *= 30;
  for (int k = 0; k < 3; k++) g[k] += away;
  if (i > 0 && kind[i - 1] == CT_SPHERE && one_in(9))
    memcpy(g, g - CT_GEOMETRY_COLUMNS, 4 * sizeof *g);
}

static void place_object(size_t i, int layout, double scale, double away) {
  double *g = geometry + i * CT_GEOMETRY_COLUMNS, *m = material + i * CT_MATERIAL_COLUMNS;
  for (int k = 0; k < 6; k++) g[k] = 0;
  for (int k = 0; k < 3; k++) color[3 * i + (size_t)k] = floor(uniform_in(0, 256));
  m[CT_KA] = 0.2, m[CT_KD] = 0.6, m[CT_KS] = one_in(2) ? 0.3 : 0, m[CT_ETA] = 20;
  m[CT_KR] = one_in(3) ? 0.4 : 0, m[CT_KT] = one_in(4) ? 0.7 : 0, m[CT_N] = 1.5;
  kind[i] = CT_SPHERE;
  if (i == 0 || one_in(200)) {
    kind[i] = CT_PLANE;
    g[5] = 1;
    for (int k = 0; k < 3; k++) g[k] = away - 6 * scale;
    return;
  }
  place_sphere(i, layout, scale, away);
}

static ct_scene_view random_scene(size_t n_objects, int layout) {
  double scale = one_in(5) ? exponential_in(1e-5, 1e5) : 1, away = one_in(5) ? 1e3 * scale : 0;
  ct_scene_view v = {.delivery = 3, .v_res = SIDE, .h_res = SIDE, .pixel_size = 2.2 / SIDE,
                     .screen_distance = 1.5, .max_depth = 3, .n_objects = n_objects,
                     .n_lights = N_LIGHTS, .kind = kind, .color = color, .material = material,
                     .geometry = geometry, .lights = lights};
  for (size_t i = 0; i < n_objects; i++) place_object(i, layout, scale, away);
  for (int k = 0; k < 3; k++) {
    v.eye[k] = uniform_in(-3, 3) * scale + away;
    v.target[k] = away;
    v.background[k] = 100;
    v.ambient[k] = 255;
    for (size_t j = 0; j < N_LIGHTS; j++) {
      lights[j * CT_LIGHT_COLUMNS + (size_t)k] = 150;
      lights[j * CT_LIGHT_COLUMNS + 3 + (size_t)k] = uniform_in(-8, 8) * scale + away;
    }
  }
  v.eye[1] -= 9 * scale;
  v.up[2] = 1;
  if (one_in(2)) { /* the eye, and a light, on a sphere */
    const double *g = geometry + (n_objects - 1) * CT_GEOMETRY_COLUMNS;
    for (int k = 0; k < 3; k++) {
      if (kind[n_objects - 1] == CT_SPHERE && layout != 2) v.eye[k] = g[k] + (k == 1 ? -g[3] : 0);
      lights[3 + k] = g[k] + (k == 2 ? g[3] : 0);
    }
  }
  return v;
}

static void set(ct_options *options, const char *name, const char *value) {
  ct_fault fault;
  CHECK(ct_options_set(options, name, value, &fault) == CT_OK);
}

static void set_readings(ct_options *options, int which, double scale) {
  char epsilon[40];
  snprintf(epsilon, sizeof epsilon, "%.17g", 1e-5 * scale);
  set(options, "epsilon", epsilon);
  if (which == 1) set(options, "offset", "mitsuba");
  if (which == 2) set(options, "offset", "bound"), set(options, "tir", "always");
  if (which == 3) set(options, "shadow_distance", "ignored"), set(options, "nesting", "tracked");
  if (which == 4) set(options, "glass_shadow", "clear"), set(options, "view", "eye");
  if (which == 5) set(options, "far", "9"), set(options, "shadow_min", "0.1");
}

static void render(const ct_scene_view *view, ct_options *options, const char *way, picture *out) {
  ct_fault fault;
  memset(out, 0x5a, sizeof *out);
  ct_outputs outputs = {.image = out->image, .object = out->object, .t_world = out->t_world,
                        .normal = out->normal, .tree = out->tree, .rays = out->rays};
  CHECK(ct_options_set_search(options, way, &fault) == CT_OK);
  CHECK(ct_render(view, options, &outputs, NULL, NULL, NULL) == CT_OK);
}

static void compare(const ct_scene_view *view, ct_options *options, const char *what) {
  render(view, options, "scan", &scanned);
  render(view, options, "tree", &found);
  if (memcmp(&scanned, &found, sizeof found) != 0) {
    for (size_t i = 0; i < N_PIXELS; i++)
      if (scanned.object[i] != found.object[i] || scanned.tree[i] != found.tree[i])
        fprintf(stderr, "%s, pixel %zu: object %d, by the tree %d\n", what, i, scanned.object[i],
                found.object[i]);
  }
  CHECK(memcmp(&scanned, &found, sizeof found) == 0);
}

static void compare_paths(const ct_scene_view *view, int reading, double scale) {
  const char *rung, *set_name;
  ct_fault fault;
  for (size_t p = 0; (rung = ct_precision_name(p)) != NULL; p++) {
    int is_slow = strcmp(rung, "dd") == 0 || strcmp(rung, "f128") == 0;
    if (is_slow && !one_in(8)) continue;
    int has_streams = strcmp(rung, "f64") == 0 || strcmp(rung, "f32") == 0;
    for (size_t k = 0; (set_name = ct_instructions_name(k)) != NULL; k++) {
      ct_options *options = ct_options_new();
      CHECK(options);
      CHECK(ct_options_set_precision(options, rung, &fault) == CT_OK);
      CHECK(ct_options_set_instructions(options, k ? set_name : "scalar", &fault) == CT_OK);
      set_readings(options, reading, scale);
      char what[80];
      snprintf(what, sizeof what, "%s %s reading %d", rung, set_name, reading);
      compare(view, options, what);
      ct_options_free(options);
      if (!has_streams) break;
    }
  }
}

typedef struct enclosures {
  double lo[N_PIXELS * 3], hi[N_PIXELS * 3], alternatives[N_PIXELS * CT_ALTERNATIVES * 6];
  uint8_t pixel_class[N_PIXELS], level[N_PIXELS], decision[N_PIXELS];
  int32_t depth[N_PIXELS], object[N_PIXELS];
} enclosures;
static enclosures by_scan, by_tree;

static void certify(const ct_scene_view *view, ct_options *options, const char *way, double kappa,
                    enclosures *out) {
  ct_fault fault;
  memset(out, 0x5a, sizeof *out);
  ct_enclosures outputs = {.lo = out->lo, .hi = out->hi, .pixel_class = out->pixel_class,
                           .level = out->level, .decision = out->decision, .depth = out->depth,
                           .object = out->object, .alternatives = out->alternatives};
  ct_certify_request request = {.tolerance = kappa > 0 ? 1e3 : 1e-9, .kappa = kappa};
  CHECK(ct_options_set_search(options, way, &fault) == CT_OK);
  CHECK(ct_certify(view, options, &request, &outputs, NULL, NULL, NULL) == CT_OK);
}

/* The same; or, of the arithmetic under test, narrower, as the tree leaves out spheres that its bounds
 * cannot tell from hit ones. */
static void check_enclosure(size_t i, int may_be_narrower) {
  int is_same = by_scan.pixel_class[i] == by_tree.pixel_class[i], is_inside = 1;
  for (size_t k = 3 * i; k < 3 * i + 3; k++) {
    is_same &= memcmp(by_scan.lo + k, by_tree.lo + k, sizeof(double)) == 0;
    is_same &= memcmp(by_scan.hi + k, by_tree.hi + k, sizeof(double)) == 0;
    is_inside &= by_scan.lo[k] <= by_tree.lo[k] && by_tree.hi[k] <= by_scan.hi[k];
  }
  int is_right = is_same || (may_be_narrower && is_inside);
  if (!is_right)
    fprintf(stderr, "pixel %zu: [%.17g, %.17g] of class %d, by the tree [%.17g, %.17g] of %d\n", i,
            by_scan.lo[3 * i], by_scan.hi[3 * i], by_scan.pixel_class[i], by_tree.lo[3 * i],
            by_tree.hi[3 * i], by_tree.pixel_class[i]);
  CHECK(is_right);
}

static void compare_enclosures(const ct_scene_view *view, int reading, double scale) {
  ct_fault fault;
  const char *set_name;
  if (reading == 2) reading = 0; /* offset=bound has no meaning in real arithmetic */
  for (size_t k = 0; (set_name = ct_instructions_name(k)) != NULL; k++) {
    ct_options *options = ct_options_new();
    CHECK(options);
    CHECK(ct_options_set_instructions(options, set_name, &fault) == CT_OK);
    set_readings(options, reading, scale);
    double kappa = one_in(4) ? 0x1p-22 : 0;
    certify(view, options, "scan", kappa, &by_scan);
    certify(view, options, "tree", kappa, &by_tree);
    for (size_t i = 0; i < N_PIXELS; i++) check_enclosure(i, kappa > 0);
    ct_options_free(options);
  }
}

int main(void) {
  ct_options *options = ct_options_new();
  ct_fault fault;
  CHECK(ct_options_set_search(options, "guess", &fault) == CT_ERR_OPTION);
  ct_options_free(options);
  for (int round = 0; round < 60; round++) {
    size_t n = round % 3 == 0 ? 1 + below(20) : 1 + below(MOST_OBJECTS - 1);
    ct_scene_view view = random_scene(n, round % 5);
    double scale = fabs(view.eye[1] - view.target[1]) / 9;
    CHECK(ct_scene_check(&view, &fault) == CT_OK);
    compare_paths(&view, round % 6, scale);
    if (round % 3 == 0 || round % 10 == 1) compare_enclosures(&view, round % 6, scale);
  }
  return 0;
}
