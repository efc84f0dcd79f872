/* Pixels whose values are known in closed form, and the machine state left as it was found. */
#include <fenv.h>
#include <math.h>
#include <string.h>

#include "check.h"
#include "crosstrace.h"
#include "test_options.h"

/* One pixel, looking down the z axis at a unit sphere in front of a background. */
#define CAMERA "1 1\n1 1\n0 0 5\n0 0 0\n0 1 0\n0 0 51\n"

static void render(const char *text, const char *reading, const char *value, double rgb[3],
                   ct_stats *stats) {
  ct_scene *scene;
  ct_fault fault;
  CHECK(ct_scene_parse(text, strlen(text), 0, &scene, &fault) == CT_OK);
  ct_options *options = test_options();
  if (reading) CHECK(ct_options_set(options, reading, value, &fault) == CT_OK);
  ct_scene_view view = ct_scene_data(scene);
  ct_outputs outputs = {.image = rgb};
  CHECK(ct_render(&view, options, &outputs, NULL, NULL, stats) == CT_OK);
  ct_options_free(options);
  ct_scene_free(scene);
}

static void is(const double rgb[3], double r, double g, double b) {
  if (fabs(rgb[0] - r) <= 1e-15 && fabs(rgb[1] - g) <= 1e-15 && fabs(rgb[2] - b) <= 1e-15) return;
  fprintf(stderr, "expected %.17g %.17g %.17g, found %.17g %.17g %.17g\n", r, g, b, rgb[0],
          rgb[1], rgb[2]);
  exit(1);
}

static void closed_forms(void) {
  double rgb[3];
  ct_stats stats;
  render(CAMERA "0\n", NULL, NULL, rgb, &stats);
  is(rgb, 0, 0, 0.2);
  render(CAMERA "1\n255 102 0 * 0 0 0 1\n", NULL, NULL, rgb, &stats);
  is(rgb, 1, 0.4, 0);
  CHECK(stats.n_primary == 1 && stats.n_shadow == 0);
  /* Light at the eye: n.l = r.wo = 1, so the pixel is ka*cd + kd*cd + ks. */
  render(CAMERA "1\n255 0 0 0.25 0.5 0.125 7 * 0 0 0 1\n255 255 255\n1\n255 255 255 0 0 5\n", NULL,
         NULL, rgb, &stats);
  is(rgb, 0.875, 0.125, 0.125);
  CHECK(stats.n_shadow == 1);
  /* The light behind the sphere: ambient alone is left. */
  render(CAMERA "1\n255 0 0 0.25 0.5 0.125 7 * 0 0 0 1\n255 255 255\n1\n255 255 255 0 0 -5\n",
         NULL, NULL, rgb, &stats);
  is(rgb, 0.25, 0, 0);
  /* A mirror at depth 1 adds kr times the background; at depth 0 nothing, or the background. */
  render(CAMERA "1\n1\n0 0 0 0 0 0 1 0.5 0 1 * 0 0 0 1\n0 0 0\n0\n", NULL, NULL, rgb, &stats);
  is(rgb, 0, 0, 0.1);
  render(CAMERA "0\n1\n0 0 0 0 0 0 1 0.5 0 1 * 0 0 0 1\n0 0 0\n0\n", NULL, NULL, rgb, &stats);
  is(rgb, 0, 0, 0);
  render(CAMERA "0\n1\n0 0 0 0 0 0 1 0.5 0 1 * 0 0 0 1\n0 0 0\n0\n", "exhausted", "background",
         rgb, &stats);
  is(rgb, 0, 0, 0.1);
  /* Straight through glass: in and out at normal incidence, kt twice. */
  render(CAMERA "2\n1\n0 0 0 0 0 0 1 0 0.5 1.5 * 0 0 0 1\n0 0 0\n0\n", NULL, NULL, rgb, &stats);
  is(rgb, 0, 0, 0.05);
  CHECK(stats.n_refracted == 2);
  render(CAMERA "2\n1\n0 0 0 0 0 0 1 0 0.5 1.5 * 0 0 0 1\n0 0 0\n0\n", "miss", "black", rgb,
         &stats);
  is(rgb, 0, 0, 0);
  /* The eye on a plane does not see it; on a sphere it sees the far side. */
  render(CAMERA "1\n255 0 0 / 0 0 5 0 0 1\n", NULL, NULL, rgb, &stats);
  is(rgb, 0, 0, 0.2);
  render(CAMERA "1\n255 0 0 * 0 0 2 3\n", NULL, NULL, rgb, &stats);
  is(rgb, 1, 0, 0);
  /* Two identical surfaces: the first in the file. */
  render(CAMERA "2\n0 255 0 * 0 0 0 1\n255 0 0 * 0 0 0 1\n", NULL, NULL, rgb, &stats);
  is(rgb, 0, 1, 0);
}

static void limits_end_in_errors(void) {
  /* Two mirrors facing each other at a depth beyond the stack, and a glass shell at 100: between
   * its two surfaces both rays of a hit stay, while a single sphere loses one of them each time. */
  const char *deep = CAMERA "2000000\n2\n0 0 0 0 0 0 1 1 0 1 / 0 0 -1 0 0 1\n"
                            "0 0 0 0 0 0 1 1 0 1 / 0 0 9 0 0 -1\n0 0 0\n0\n";
  const char *wide = CAMERA "100\n2\n0 0 0 0 0 0 1 0.5 0.5 1.5 * 0 0 0 1\n"
                            "0 0 0 0 0 0 1 0.5 0.5 1.3 * 0 0 0 0.5\n0 0 0\n0\n";
  ct_scene *scene;
  ct_fault fault;
  double rgb[3];
  ct_outputs outputs = {.image = rgb};
  ct_options *options = test_options();
  ct_options_set_ray_budget(options, 1000000);
  CHECK(ct_scene_parse(deep, strlen(deep), 0, &scene, &fault) == CT_OK);
  ct_scene_view view = ct_scene_data(scene);
  CHECK(ct_render(&view, options, &outputs, NULL, NULL, NULL) == CT_ERR_DEPTH);
  ct_scene_free(scene);
  CHECK(ct_scene_parse(wide, strlen(wide), 0, &scene, &fault) == CT_OK);
  view = ct_scene_data(scene);
  CHECK(ct_render(&view, options, &outputs, NULL, NULL, NULL) == CT_ERR_BUDGET);
  ct_scene_free(scene);
  ct_options_free(options);
}

static void a_straight_path_through_one_sphere_stays_straight(void) {
  /* At each inner hit one ray leaves for good: 2 rays a depth. Normals that are not of length 1
   * once turned rounding into a tree of thousands of rays here from depth 20 on. */
  double rgb[3];
  ct_stats stats;
  render(CAMERA "100\n1\n0 0 0 0 0 0 1 0.5 0.5 1.5 * 0 0 0 1\n0 0 0\n0\n", NULL, NULL, rgb,
         &stats);
  CHECK(stats.n_reflected == 100 && stats.n_refracted == 100);
}

static void the_callers_rounding_mode_is_given_back(void) {
  double first[3], second[3];
  ct_stats stats;
  const char *text =
      CAMERA "1\n255 10 0 0.3 0.5 0.1 7 * 0.1 0 0 1\n255 255 255\n1\n255 255 255 1 2 5\n";
  render(text, NULL, NULL, first, &stats);
  CHECK(fesetround(FE_UPWARD) == 0);
  render(text, NULL, NULL, second, &stats);
  CHECK(fegetround() == FE_UPWARD);
  CHECK(fesetround(FE_TONEAREST) == 0);
  CHECK(memcmp(first, second, sizeof first) == 0);
}

int main(void) {
  closed_forms();
  limits_end_in_errors();
  a_straight_path_through_one_sphere_stays_straight();
  the_callers_rounding_mode_is_given_back();
  return 0;
}
