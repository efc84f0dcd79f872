/* Nearest hits of any number of rays stay within the caller's arrays and are those of one at a
 * time; a tolerance darkens by no more than itself, and sends fewer rays. */
#include <math.h>
#include <string.h>

#include "check.h"
#include "crosstrace.h"
#include "test_options.h"

enum { ROWS = 45, COLUMNS = 61, VALUES = ROWS * COLUMNS * 3 };

static const char scene_text[] =
    "45 61\n0.02 1\n0 -6 1.5\n0 0 0.8\n0 0 1\n120 170 230\n6\n3\n"
    "220 220 220 0.2 0.7 0 1 0.2 0 1 / 0 0 0 0 0 1\n"
    "230 60 60 0.1 0.7 0.4 50 0.1 0 1 * -1.1 1 1 1\n"
    "30 30 30 0 0.1 0.5 200 0.1 0.8 1.5 * 0.3 -0.5 1 1\n"
    "255 255 255\n2\n150 150 150 -4 -5 6\n120 120 120 3 -2 5\n";

static double full[VALUES], pruned[VALUES];

/* Arrays of exactly n items each, so that a sanitizer sees a step beyond. */
static void check_rays(const ct_scene_view *view, const ct_options *options, size_t n) {
  double *origin = malloc((3 * n + 1) * sizeof *origin), *way = malloc((3 * n + 1) * sizeof *way);
  double *t = malloc((n + 1) * sizeof *t), one, seconds = -1;
  int64_t *object = malloc((n + 1) * sizeof *object), alone;
  CHECK(origin && way && t && object);
  t[n] = -7;
  object[n] = -7;
  for (size_t k = 0; k < n; k++) {
    double angle = 0.37 * (double)k, rise = 0.2 * sin(1.7 * (double)k);
    double c = sqrt(1 - rise * rise);
    origin[k] = 0.01 * (double)(k % 13);
    origin[n + k] = -6;
    origin[2 * n + k] = 1.5;
    way[k] = c * sin(0.2 * sin(angle));
    way[n + k] = c * cos(0.2 * sin(angle));
    way[2 * n + k] = rise;
  }
  ct_rays rays = {n, {origin, origin + n, origin + 2 * n}, {way, way + n, way + 2 * n}};
  CHECK(ct_intersect(view, options, &rays, 2, t, object, &seconds) == CT_OK);
  CHECK(t[n] == -7 && object[n] == -7 && seconds >= 0);
  for (size_t k = 0; k < n; k++) {
    ct_rays single = {1, {origin + k, origin + n + k, origin + 2 * n + k},
                      {way + k, way + n + k, way + 2 * n + k}};
    CHECK(ct_intersect(view, options, &single, 1, &one, &alone, NULL) == CT_OK);
    CHECK(alone == object[k] && memcmp(&one, t + k, sizeof one) == 0);
    CHECK(isinf(one) == (alone < 0));
  }
  free(origin);
  free(way);
  free(t);
  free(object);
}

static void check_pruning(const ct_scene_view *view, ct_options *options) {
  ct_fault fault;
  ct_stats all, some;
  ct_outputs out = {.image = full};
  CHECK(ct_render(view, options, &out, NULL, NULL, &all) == CT_OK);
  out.image = pruned;
  CHECK(ct_options_set_tolerance(options, 0.05, &fault) == CT_OK);
  CHECK(ct_render(view, options, &out, NULL, NULL, &some) == CT_OK);
  CHECK(some.n_reflected + some.n_refracted < all.n_reflected + all.n_refracted);
  for (int k = 0; k < VALUES; k++) CHECK(pruned[k] <= full[k] && full[k] - pruned[k] <= 0.05);
  CHECK(ct_options_set_tolerance(options, -1, &fault) == CT_ERR_OPTION);
  CHECK(ct_options_set_tolerance(options, (double)NAN, &fault) == CT_ERR_OPTION);
  CHECK(ct_options_set_tolerance(options, 0, &fault) == CT_OK);
}

int main(void) {
  ct_scene *scene;
  ct_fault fault;
  CHECK(ct_scene_parse(scene_text, strlen(scene_text), 0, &scene, &fault) == CT_OK);
  ct_scene_view view = ct_scene_data(scene);
  ct_options *options = test_options();
  for (size_t n = 0; n <= 17; n++) check_rays(&view, options, n);
  check_rays(&view, options, 255);
  check_rays(&view, options, 257);
  check_rays(&view, options, 600);
  check_pruning(&view, options);
  CHECK(ct_options_set_search(options, "tree", &fault) == CT_OK);
  check_rays(&view, options, 300);
  CHECK(ct_options_set_precision(options, "f32", &fault) == CT_OK);
  check_pruning(&view, options);
  double number = 0;
  int64_t object = 0;
  ct_rays none = {0};
  CHECK(ct_intersect(&view, options, &none, 1, &number, &object, NULL) == CT_ERR_OPTION);
  CHECK(ct_intersect(&view, options, &none, 0, &number, &object, NULL) == CT_ERR_ARGUMENT);
  CHECK(ct_peak_flops(NULL, 0) == 0);
  ct_options_free(options);
  ct_scene_free(scene);
  return 0;
}
