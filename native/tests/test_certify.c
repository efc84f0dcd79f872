/* Enclosures hold closed-form values and the tracer's own, and open decisions are said to be open. */
#include <math.h>
#include <string.h>

#include "check.h"
#include "crosstrace.h"
#include "test_options.h"

#define CAMERA "1 1\n1 1\n0 0 5\n0 0 0\n0 1 0\n0 0 51\n"

typedef struct answer {
  double lo[3], hi[3], alternatives[CT_ALTERNATIVES * 6];
  uint8_t pixel_class, decision, n_alternatives, level, unused[4];
} answer;

static answer certify_capped(const char *text, const char *reading, const char *value,
                             const char *most, double tolerance) {
  ct_scene *scene;
  ct_fault fault;
  answer a;
  memset(&a, 0, sizeof a);
  CHECK(ct_scene_parse(text, strlen(text), 0, &scene, &fault) == CT_OK);
  ct_options *options = test_options();
  if (reading) CHECK(ct_options_set(options, reading, value, &fault) == CT_OK);
  if (most) CHECK(ct_options_set_instructions(options, most, &fault) == CT_OK);
  ct_scene_view view = ct_scene_data(scene);
  ct_certify_request request = {.tolerance = tolerance};
  ct_enclosures out = {.lo = a.lo, .hi = a.hi, .pixel_class = &a.pixel_class,
                       .decision = &a.decision, .level = &a.level,
                       .n_alternatives = &a.n_alternatives, .alternatives = a.alternatives};
  CHECK(ct_certify(&view, options, &request, &out, NULL, NULL, NULL) == CT_OK);
  ct_options_free(options);
  ct_scene_free(scene);
  return a;
}

static answer certify(const char *text, const char *reading, const char *value) {
  return certify_capped(text, reading, value, NULL, 1e-9);
}

/* Every instruction set of the processor encloses alike, in each type of bounds. */
static void instruction_sets_change_no_bit(const char *text, double tolerance, int level) {
  answer one = certify_capped(text, NULL, NULL, "native", tolerance);
  CHECK(one.level == level);
  for (size_t i = 0; ct_instructions_name(i); i++) {
    answer other = certify_capped(text, NULL, NULL, ct_instructions_name(i), tolerance);
    CHECK(memcmp(&one, &other, sizeof one) == 0);
  }
}

/* The value lies in the enclosure, but for the rounding of the literal itself. */
static void holds(answer a, double r, double g, double b) {
  const double value[3] = {r, g, b};
  CHECK(a.pixel_class == CT_CERTIFIED);
  for (int k = 0; k < 3; k++) {
    CHECK(a.lo[k] <= value[k] + 1e-16 && value[k] - 1e-16 <= a.hi[k]);
    CHECK(a.hi[k] - a.lo[k] < 1e-12);
  }
}

int main(void) {
  holds(certify(CAMERA "0\n", NULL, NULL), 0, 0, 0.2);
  holds(certify(CAMERA "1\n255 102 0 * 0 0 0 1\n", NULL, NULL), 1, 0.4, 0);
  holds(certify(CAMERA "1\n255 0 0 0.25 0.5 0.125 7 * 0 0 0 1\n255 255 255\n1\n"
                       "255 255 255 0 0 5\n", NULL, NULL), 0.875, 0.125, 0.125);
  const char *slanted =
      "1 1\n1 1\n0 0 5\n0 0 0\n0 1 0\n0 0 0\n1\n255 255 255 0 0.5 0.5 2.5 / 0 0 0 0 0 1\n"
      "0 0 0\n1\n255 255 255 3 0 3\n";
  /* A light at 45 degrees over a plane: n.l = r.wo = sqrt(1/2), whose power 2.5 is 2^-1.25. */
  holds(certify(slanted, NULL, NULL),
        0.5 * sqrt(0.5) + 0.5 * pow(2, -1.25), 0.5 * sqrt(0.5) + 0.5 * pow(2, -1.25),
        0.5 * sqrt(0.5) + 0.5 * pow(2, -1.25));
  holds(certify(CAMERA "2\n1\n0 0 0 0 0 0 1 0 0.5 1.5 * 0 0 0 1\n0 0 0\n0\n", NULL, NULL), 0, 0,
        0.05);
  /* Decided exactly: the eye on a plane, and two identical surfaces. */
  holds(certify(CAMERA "1\n255 0 0 / 0 0 5 0 0 1\n", NULL, NULL), 0, 0, 0.2);
  holds(certify(CAMERA "2\n0 255 0 * 0 0 0 1\n255 0 0 * 0 0 0 1\n", NULL, NULL), 0, 1, 0);

  /* One plane spelled twice, with numbers that are exact: the first in the file. */
  holds(certify(CAMERA "2\n255 0 0 / 0 0 0 0 0 1\n0 255 0 / 1 0 0 0 0 2\n", NULL, NULL), 1, 0, 0);
  /* A ray that touches the sphere in one point, in numbers that are exact: a hit. */
  holds(certify("1 1\n1 1\n1 0 5\n1 0 0\n0 1 0\n0 0 51\n1\n255 0 0 * 0 0 0 1\n", NULL, NULL), 1, 0,
        0);

  /* A light exactly on a plane is not behind it: n.l = 8 / sqrt(73) from the ground below. */
  holds(certify(CAMERA "2\n255 255 255 0 0.5 0 1 / 0 0 0 0 0 1\n9 9 9 0 0 0 1 / 1 1 8 0 0 3\n0 0 0\n1\n"
                       "255 255 255 3 0 8\n", NULL, NULL),
        4 / sqrt(73), 4 / sqrt(73), 4 / sqrt(73));

  /* The ray meets the edge between two planes at an irrational distance: no width of arithmetic
   * tells which is in front. */
  const char *two_planes = "1 1\n1 1\n0 1 5\n0 0 0\n0 1 0\n0 0 51\n2\n255 0 0 / 0 0 0 1 0 1\n"
                           "0 255 0 / 0 0 0 -1 0 1\n";
  answer edge = certify(two_planes, NULL, NULL);
  CHECK(edge.pixel_class == CT_UNDECIDABLE_EDGE && edge.decision == CT_DECISION_NEAREST);
  CHECK(edge.n_alternatives == 2);
  CHECK(edge.lo[0] == 0 && edge.hi[0] == 1 && edge.lo[1] == 0 && edge.hi[1] == 1);

  instruction_sets_change_no_bit(slanted, 1e-9, 0);
  instruction_sets_change_no_bit(slanted, 4e-16, 1);
  instruction_sets_change_no_bit(two_planes, 1e-9, 2);
  return 0;
}
