/* Recorded ray trees: the very bits of ct_render, every ray of it, and what is known in closed form
 * of hits, margins and terms. */
#include <fenv.h>
#include <math.h>
#include <string.h>

#include "check.h"
#include "crosstrace.h"
#include "test_options.h"

enum { SIDE = 21, MOST = 4096 };

/* Mirror, glass inside glass, a raw plane normal, the eye in front of everything. */
static const char scene_text[] =
    "21 21\n0.05 1\n0 -6 1.5\n0 0 0.8\n0 0 1\n120 170 230\n4\n4\n"
    "220 220 220 0.2 0.7 0.3 4 0.2 0 1 / 0 0 0 0 0 2\n"
    "230 60 60 0.1 0.7 0.4 50.5 0.1 0 1 * -1.1 1 1 1\n"
    "30 30 30 0 0.1 0.5 200 0.1 0.8 1.5 * 0.3 -0.5 1 1\n"
    "30 90 30 0 0.1 0.5 20 0.1 0.8 0.7 * 0.3 -0.5 1.2 0.5\n"
    "255 255 255\n2\n150 150 150 -4 -5 6\n120 120 120 3 -2 5\n";

static ct_ray_record rays[MOST];

static ct_scene *read_scene(const char *text) {
  ct_scene *scene;
  ct_fault fault;
  CHECK(ct_scene_parse(text, strlen(text), 0, &scene, &fault) == CT_OK);
  return scene;
}

/* What a ray returns, from the terms of its record and the colours of the rays that it sends. */
static void terms_add_up(const ct_ray_record *r, size_t n, size_t i) {
  double sum[3], lights[3] = {0, 0, 0};
  for (int k = 0; k < 3; k++)
    sum[k] = r[i].base[k] + r[i].diffuse[k] + r[i].specular[k] + r[i].unsent[k];
  for (size_t j = i + 1; j < n; j++) {
    if (r[j].parent != (int64_t)i) continue;
    int is_shadow = r[j].kind == CT_RAY_SHADOW;
    CHECK(r[j].depth == r[i].depth + !is_shadow);
    for (int k = 0; k < 3; k++)
      if (is_shadow)
        lights[k] += r[j].color[k];
      else
        sum[k] += r[j].weight / r[i].weight * r[j].color[k];
  }
  for (int k = 0; k < 3; k++) {
    CHECK(fabs(sum[k] - r[i].color[k]) <= 1e-14 * (1 + sum[k]));
    /* Whether a light counts is the tracer's own decision: its terms hold what is not blocked. */
    CHECK(fabs(lights[k] - r[i].diffuse[k] - r[i].specular[k]) <= 1e-14 * (1 + lights[k]));
  }
}

static void tree_is_that_of_the_renderer(const char *name, const char *value) {
  static double image[SIDE * SIDE * 3];
  static uint64_t trees[SIDE * SIDE];
  static uint32_t counts[SIDE * SIDE];
  ct_fault fault;
  ct_scene *scene = read_scene(scene_text);
  ct_scene_view view = ct_scene_data(scene);
  ct_options *options = test_options();
  if (name) CHECK(ct_options_set(options, name, value, &fault) == CT_OK);
  ct_outputs out = {.image = image, .tree = trees, .rays = counts};
  CHECK(ct_render(&view, options, &out, NULL, NULL, NULL) == CT_OK);
  int is_limited = name && strcmp(name, "recursion") == 0;
  for (size_t at = 0; at < SIDE * SIDE; at++) {
    ct_pixel_tree tree;
    CHECK(ct_explain(&view, options, (int64_t)at / SIDE, (int64_t)at % SIDE, rays, MOST, &tree,
                     NULL, NULL) == CT_OK);
    CHECK(tree.tree == trees[at] && tree.n_rays == counts[at] && tree.n_rays <= MOST);
    CHECK(memcmp(tree.color, image + 3 * at, sizeof tree.color) == 0);
    CHECK(rays[0].kind == CT_RAY_PRIMARY && rays[0].parent == -1 && rays[0].weight == 1);
    CHECK(memcmp(rays[0].color, tree.color, sizeof tree.color) == 0);
    for (size_t i = 0; i < tree.n_rays; i++) {
      CHECK(rays[i].margin >= 0 && rays[i].clearance >= 0);
      CHECK((rays[i].margin < (double)INFINITY) == (rays[i].margin_decision != CT_DECISION_NONE));
      CHECK((rays[i].t_world < (double)INFINITY) == (rays[i].object >= 0));
      if (!is_limited && rays[i].kind != CT_RAY_SHADOW) terms_add_up(rays, tree.n_rays, i);
    }
  }
  ct_options_free(options);
  ct_scene_free(scene);
}

static ct_pixel_tree explain(const char *text, const char *name, const char *value) {
  ct_fault fault;
  ct_pixel_tree tree;
  ct_scene *scene = read_scene(text);
  ct_scene_view view = ct_scene_data(scene);
  ct_options *options = test_options();
  if (name) CHECK(ct_options_set(options, name, value, &fault) == CT_OK);
  memset(rays, 0xff, sizeof rays);
  CHECK(ct_explain(&view, options, 0, 0, rays, MOST, &tree, NULL, NULL) == CT_OK);
  ct_options_free(options);
  ct_scene_free(scene);
  return tree;
}

#define is(found, expected) is_(__LINE__, found, expected)
static void is_(int line, double found, double expected) {
  if (found == expected || fabs(found - expected) <= 1e-12 * (1 + fabs(expected))) return;
  fprintf(stderr, "line %d: expected %.17g, found %.17g\n", line, expected, found);
  exit(1);
}

#define margin_is(ray, margin, decision, object) margin_is_(__LINE__, ray, margin, decision, object)
static void margin_is_(int line, const ct_ray_record *ray, double margin, int decision,
                       int64_t object) {
  is_(line, ray->margin, margin);
  CHECK(ray->margin_decision == decision && ray->margin_object == object);
}

/* One pixel whose ray runs down the z axis from the eye at z = 5. */
#define DOWN "1 1\n1 1\n0 0 5\n0 0 0\n0 1 0\n0 0 51\n"

static void nearest_hits_and_their_margins(void) {
  /* The centre of a unit sphere is met: t = 4; the plane behind it at t = 6 is half of that away. */
  explain(DOWN "2\n255 102 0 * 0 0 0 1\n9 9 9 / 0 0 -1 0 0 1\n", NULL, NULL);
  CHECK(rays[0].object == 0 && rays[0].inside == 0);
  is(rays[0].t_world, 4);
  is(rays[0].point[2], 1);
  is(rays[0].normal[2], 1);
  is(rays[0].color[1], 0.4);
  margin_is(&rays[0], 0.5, CT_DECISION_NEAREST, 1);
  /* A surface that is textually the same is no alternative; one spelled otherwise is a tie. */
  explain(DOWN "2\n255 0 0 / 0 0 1 0 0 1\n0 9 0 / 0 0 1 0 0 1\n", NULL, NULL);
  margin_is(&rays[0], 4. / 6, CT_DECISION_NEAREST, 0); /* how far the eye is off it */
  explain(DOWN "2\n255 0 0 / 0 0 1 0 0 1\n0 9 0 / 0 0 1 0 0 2\n", NULL, NULL);
  CHECK(rays[0].object == 0);
  margin_is(&rays[0], 0, CT_DECISION_NEAREST, 1);
  /* The ray passes a sphere of radius 1 at 1.25: |1 - 1.25^2| = 0.5625; at 0.75: 0.4375. */
  explain(DOWN "1\n255 0 0 * 1.25 0 0 1\n", NULL, NULL);
  CHECK(rays[0].object == -1 && rays[0].t_world == (double)INFINITY);
  margin_is(&rays[0], 0.5625, CT_DECISION_NEAREST, 0);
  explain(DOWN "1\n255 0 0 * 0.75 0 0 1\n", NULL, NULL);
  CHECK(rays[0].object == 0);
  margin_is(&rays[0], 0.4375, CT_DECISION_NEAREST, 0);
  /* The same near miss counts before a hit and not behind it. */
  explain(DOWN "2\n9 9 9 / 0 0 -20 0 0 1\n255 0 0 * 1.25 0 0 1\n", NULL, NULL);
  margin_is(&rays[0], 0.5625, CT_DECISION_NEAREST, 1);
  explain(DOWN "2\n9 9 9 / 0 0 1.25 0 0 1\n255 0 0 * 1.25 0 0 1\n", NULL, NULL);
  margin_is(&rays[0], 3.75 / 6.25, CT_DECISION_NEAREST, 0);
  /* An eye on a surface is decided: only the sphere's centre line, b / r = 1, is left. */
  explain(DOWN "1\n255 0 0 * 0 0 2 3\n", NULL, NULL);
  is(rays[0].t_world, 6);
  margin_is(&rays[0], 1, CT_DECISION_NEAREST, 0);
  explain(DOWN "1\n255 0 0 / 0 0 5 0 0 1\n", NULL, NULL);
  CHECK(rays[0].object == -1);
  margin_is(&rays[0], (double)INFINITY, CT_DECISION_NONE, -1);
  /* A limit of distance, 1/16 of itself beyond the hit at t = 4. */
  explain(DOWN "1\n255 0 0 * 0 0 0 1\n", "far", "4.25");
  margin_is(&rays[0], 0.25 / 4.25, CT_DECISION_NEAREST, 0);
  explain(DOWN "1\n255 0 0 * 0 0 0 1\n", "far", "3.75");
  CHECK(rays[0].object == -1);
  margin_is(&rays[0], 0.25 / 3.75, CT_DECISION_NEAREST, 0);
}

/* A white plane under the eye with kd = 1/2, ks = 1/4, eta = 2, and a light at height 8 above the
 * hit, where n.l = r.wo = 1: 1/2 + 1/4. */
#define LIT(more, n) \
  DOWN n "\n255 255 255 0 0.5 0.25 2 / 0 0 0 0 0 1\n" more "0 0 0\n1\n255 255 255 0 0 8\n"

static void shadow_rays_and_their_margins(void) {
  CHECK(explain(LIT("", "1"), NULL, NULL).n_rays == 2);
  const ct_ray_record *feeler = &rays[1];
  CHECK(feeler->kind == CT_RAY_SHADOW && feeler->parent == 0 && feeler->light == 0);
  CHECK(feeler->object == -1 && feeler->weight == 1 && feeler->depth == 0);
  is(feeler->light_distance, 8);
  is(feeler->origin[2], 1e-5);
  is(feeler->direction[2], 1);
  is(feeler->diffuse[0], 0.5);
  is(feeler->specular[0], 0.25);
  is(feeler->color[0], 0.75);
  is(rays[0].diffuse[0], 0.5);
  is(rays[0].specular[0], 0.25);
  /* Nothing but the surface that it leaves: 1e-5 of the same magnitude. */
  margin_is(feeler, (double)INFINITY, CT_DECISION_NONE, -1);
  is(feeler->clearance, 1);
  /* A sphere beside the feeler: 1.25 from its line. The eye sees the plane, t = 5, past it. */
  explain(LIT("9 9 9 0 0 0 1 * 1.25 0 4 1\n", "2"), NULL, NULL);
  CHECK(rays[1].object == -1);
  margin_is(&rays[1], 0.5625, CT_DECISION_SHADOW, 1);
  /* A sphere before the light, met at 0.75 from its axis, and one that covers the middle: the
   * surest of the two counts, and the first in the file is named. */
  explain(LIT("9 9 9 0 0 0 1 * 0.75 0 6.5 1\n9 9 9 0 0 0 1 * 0 0 6.5 1\n", "3"), NULL, NULL);
  CHECK(rays[1].object == 1 && rays[1].color[0] == 0 && rays[0].diffuse[0] == 0);
  is(rays[1].diffuse[0], 0.5);
  is(rays[1].t_world, 6.5 - sqrt(0.4375) - 1e-5);
  is(rays[1].light_distance, 8);
  margin_is(&rays[1], (8 - 5.5) / (8 - 1e-5), CT_DECISION_SHADOW, 2);
  /* Beyond the light: 9.5 - 1 - 8 = 0.5 behind it. */
  explain(LIT("9 9 9 0 0 0 1 * 0 0 9.5 1\n", "2"), NULL, NULL);
  CHECK(rays[1].object == -1);
  margin_is(&rays[1], 0.5 / (8 - 1e-5), CT_DECISION_SHADOW, 1);
  /* Where blockers beyond the light count, it is in the way, and the edge decides: l = 0. */
  explain(LIT("9 9 9 0 0 0 1 * 0 0 9.5 1\n", "2"), "shadow_distance", "ignored");
  CHECK(rays[1].object == 1);
  margin_is(&rays[1], (9.5 - 1e-5 - 1) / 9.5, CT_DECISION_SHADOW, 1);
  /* The light exactly on a plane is decided. */
  explain(LIT("9 9 9 0 0 0 1 / 0 0 8 0 0 1\n", "2"), NULL, NULL);
  margin_is(&rays[1], (double)INFINITY, CT_DECISION_NONE, -1);
}

static void sides_and_total_reflection(void) {
  /* Straight through a glass sphere, n = 1.5, kt = 1/2: weights 1, 1/2, 1/4; Delta = 1. */
  CHECK(explain(DOWN "2\n1\n0 0 0 0 0 0 1 0 0.5 1.5 * 0 0 0 1\n0 0 0\n0\n", NULL, NULL).n_rays ==
        3);
  for (int i = 0; i < 3; i++) is(rays[i].weight, 1 / pow(2, i));
  CHECK(rays[1].kind == CT_RAY_REFRACTED && rays[1].inside == 1 && rays[0].inside == 0);
  CHECK(rays[2].object == -1 && rays[2].parent == 1 && rays[2].depth == 2);
  is(rays[1].t_world, 2 - 1e-5);
  is(rays[2].base[2], 0.2);
  is(rays[0].color[2], 0.05);
  is(rays[1].clearance, 1e-5);
  /* The glass below the plane, seen from below at 30 degrees from its normal: sin^2 = 1/4, and
   * Delta = 1 - 1.5^2 / 4 = 0.4375; at n = 2.5 it is 1 - 6.25 / 4 < 0. */
  char text[400];
  for (int total = 0; total <= 1; total++) {
    snprintf(text, sizeof text,
             "1 1\n1 1\n0 -1 -1.7320508075688772\n0 0 0\n1 0 0\n0 0 51\n1\n1\n"
             "0 0 0 0 0 0 1 0 0.5 %s / 0 0 0 0 0 1\n0 0 0\n0\n", total ? "2.5" : "1.5");
    CHECK(explain(text, NULL, NULL).n_rays == 2);
    CHECK(rays[0].inside == 1 && rays[0].total == total);
    CHECK(rays[1].kind == (total ? CT_RAY_TOTALLY_REFLECTED : CT_RAY_REFRACTED));
    is(rays[1].weight, total ? 1 : 0.5);
    margin_is(&rays[0], total ? 0.5625 : 0.4375, CT_DECISION_TOTAL, 0);
  }
  /* Inverted, n = 2.5 lets it pass: Delta = 1 - 1 / 25, and n.wo = sqrt(3)/2 is nearer. */
  explain(text, "refraction", "inverted");
  margin_is(&rays[0], sqrt(0.75), CT_DECISION_NEAREST, 0);
}

static void readings_that_add_decisions(void) {
  /* A light at sin = 1/8 over the plane: n.l = 1/8 decides where the highlight is gated by it. */
  const char *low = DOWN "1\n255 255 255 0 0.5 0.25 2 / 0 0 0 0 0 1\n0 0 0\n1\n"
                         "255 255 255 7.9372539331937721 0 1\n";
  explain(low, NULL, NULL);
  CHECK(rays[0].margin_decision == CT_DECISION_NEAREST);
  explain(low, "specular_gate", "lit");
  margin_is(&rays[0], 0.125, CT_DECISION_GATE, 0);
  /* A ray that is not sent for want of depth, as a term of its own: kr * background. */
  CHECK(explain(DOWN "0\n1\n0 0 0 0 0 0 1 0.5 0 1 * 0 0 0 1\n0 0 0\n0\n", "exhausted",
                "background").n_rays == 1);
  is(rays[0].unsent[2], 0.1);
  is(rays[0].color[2], 0.1);
}

static void what_is_refused(void) {
  ct_fault fault;
  ct_pixel_tree tree;
  ct_scene *scene = read_scene(scene_text);
  ct_scene_view view = ct_scene_data(scene);
  ct_options *options = test_options();
  CHECK(ct_explain(&view, options, SIDE, 0, rays, MOST, &tree, NULL, NULL) == CT_ERR_ARGUMENT);
  CHECK(ct_explain(&view, options, 0, -1, rays, MOST, &tree, NULL, NULL) == CT_ERR_ARGUMENT);
  CHECK(ct_explain(&view, options, 0, 0, NULL, 1, &tree, NULL, NULL) == CT_ERR_ARGUMENT);
  CHECK(ct_options_set_precision(options, "dd", &fault) == CT_OK);
  CHECK(ct_explain(&view, options, 0, 0, rays, MOST, &tree, NULL, NULL) == CT_ERR_OPTION);
  CHECK(ct_options_set_precision(options, "f64", &fault) == CT_OK);

  /* Rays beyond the capacity are counted and not written; the caller's rounding mode stays. */
  ct_pixel_tree whole;
  CHECK(ct_explain(&view, options, 12, 12, rays, MOST, &whole, NULL, NULL) == CT_OK);
  CHECK(whole.n_rays > 4);
  static ct_ray_record few[4];
  memset(few, 0xff, sizeof few);
  CHECK(fesetround(FE_UPWARD) == 0);
  CHECK(ct_explain(&view, options, 12, 12, few, 3, &tree, NULL, NULL) == CT_OK);
  CHECK(fegetround() == FE_UPWARD && fesetround(FE_TONEAREST) == 0);
  CHECK(memcmp(&tree, &whole, sizeof tree) == 0);
  CHECK(memcmp(few, rays, 3 * sizeof *few) == 0 && few[3].kind == -1);
  CHECK(ct_explain(&view, options, 12, 12, NULL, 0, &tree, NULL, NULL) == CT_OK);
  CHECK(tree.n_rays == whole.n_rays);
  ct_options_free(options);
  ct_scene_free(scene);
}

static void the_deepest_tree_has_stack(void) {
  ct_pixel_tree tree = explain("1 1\n1 1\n0 0 5\n0 0 0\n0 1 0\n0 0 51\n99999\n2\n"
                               "0 0 0 0 0 0 1 1 0 1 / 0 0 -1 0 0 1\n"
                               "0 0 0 0 0 0 1 1 0 1 / 0 0 9 0 0 -1\n0 0 0\n0\n",
                               NULL, NULL);
  CHECK(tree.n_rays == 100000 && rays[MOST - 1].depth == MOST - 1);
}

int main(void) {
  tree_is_that_of_the_renderer(NULL, NULL);
  tree_is_that_of_the_renderer("epsilon", "1e-3");
  tree_is_that_of_the_renderer("far", "6.5");
  tree_is_that_of_the_renderer("shadow_min", "1e-2");
  for (size_t i = 0; ct_reading_name(i); i++) {
    const char *values = ct_reading_values(i);
    if (strcmp(values, "NUMBER") == 0) continue;
    for (const char *at = values; *at;) {
      char value[40] = {0};
      size_t n = strcspn(at, "|");
      memcpy(value, at, n);
      tree_is_that_of_the_renderer(ct_reading_name(i), value);
      at += n + (at[n] == '|');
    }
  }
  nearest_hits_and_their_margins();
  shadow_rays_and_their_margins();
  sides_and_total_reflection();
  readings_that_add_decisions();
  what_is_refused();
  the_deepest_tree_has_stack();
  return 0;
}
