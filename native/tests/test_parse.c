/* Scene files: the three deliveries told apart, real-world spelling, and every fault located. */
#include <string.h>

#include "check.h"
#include "crosstrace.h"

#define HEADER "4 6\n0.5 2\n0 0 5\n0 0 0\n0 1 0\n10 20 30\n"

static int delivery_of(const char *text) {
  ct_scene *scene;
  ct_fault fault;
  if (ct_scene_parse(text, strlen(text), 0, &scene, &fault) != CT_OK) {
    fprintf(stderr, "%zu:%zu: expected %s, found %s\n", fault.line, fault.column, fault.expected,
            fault.found);
    return 0;
  }
  int delivery = ct_scene_data(scene).delivery;
  ct_scene_free(scene);
  return delivery;
}

static void deliveries_are_told_apart(void) {
  CHECK(delivery_of(HEADER "1\n255 0 0 * 0 0 0 1\n") == 1);
  CHECK(delivery_of(HEADER "0\n") == 1);
  CHECK(delivery_of(HEADER "1\n255 0 0 .1 .2 .3 4 / 0 0 0 0 0 1\n255 255 255\n0\n") == 2);
  CHECK(delivery_of(HEADER "0\n255 255 255\n1\n9 9 9 1 2 3\n") == 2);
  CHECK(delivery_of(HEADER "3\n1\n2 0 0 .1 .2 .3 4 .5 .6 1.5 * 0 0 0 1\n5 5 5\n0") == 3);
  CHECK(delivery_of(HEADER "3\n0\n255 255 255\n0\n") == 3);
}

static void real_files_are_read(void) {
  CHECK(delivery_of("\xef\xbb\xbf" HEADER "1\n255 0 0 * 0 0 0 1") == 1);
  CHECK(delivery_of("4.0 6.0\r\n.5 2.\r\n0\t0 5\r\n\r\n0 0 0 0 1 0 1 2 3 1e0 5 5 5*0 0 0 1\r\n") == 1);
}

static void refuses(const char *text, size_t line, size_t column, const char *expected,
                    const char *found) {
  ct_scene *scene = (ct_scene *)&scene;
  ct_fault fault;
  ct_status status = ct_scene_parse(text, strlen(text), 0, &scene, &fault);
  if (status != CT_ERR_SCENE || scene || fault.line != line || fault.column != column ||
      !strstr(fault.expected, expected) || strcmp(fault.found, found) != 0) {
    fprintf(stderr, "%s\nstatus %d, %zu:%zu: expected %s, found %s\n", text, (int)status,
            fault.line, fault.column, fault.expected, fault.found);
    exit(1);
  }
}

static void faults_are_located(void) {
  refuses("", 1, 1, "number (v_res)", "end of file");
  refuses("4 x", 1, 3, "a number", "'x'");
  refuses("0 6", 1, 1, "an integer from 1", "'0'");
  refuses("4.5 6", 1, 1, "an integer from 1", "'4.5'");
  refuses("4 6\n0 2", 2, 1, "greater than 0 (the pixel size", "'0'");
  refuses("4 6\n1 -2", 2, 3, "greater than 0 (the distance", "'-2'");
  refuses("4 6\n1 2\n0 0 5\n0 0 5\n", 4, 1, "other than the eye", "'0'");
  refuses("4 6\n1 2\n0 0 5\n0 0 0\n 0 0 -3\n", 5, 2, "not parallel", "'0'");
  refuses("4 6\n1 2\n0 0 5\n0 0 0\n0 1 0\n0 256 0", 6, 3, "from 0 to 255", "'256'");
  refuses("4 6\n1 2\n0 0 1e999\n", 3, 5, "that a double can hold", "'1e999'");
  refuses("4 6\n1 2\n0 0 1e101\n", 3, 5, "at most 1e100", "'1e101'");
  refuses("4 6\n1 2\n0 \xc3\xa9 nan\n", 3, 3, "a number", "'\\xc3\\xa9'");
  refuses(HEADER "1\n255 0 * 0 0 0 1", 8, 7, "4, 8 or 12 numbers", "'*'");
  refuses(HEADER "1 2", 7, 4, "1, 5 + 6k or 6 + 6k", "end of file");
  refuses(HEADER "2\n255 0 0 * 0 0 0 1\n", 9, 1, "a number (the object's colour)", "end of file");
  refuses(HEADER "1\n255 0 0 * 0 0 0 1\n7", 9, 1, "end of file", "'7'");
  refuses(HEADER "-1\n255 0 0 * 0 0 0 1\n", 7, 1, "an integer from 0", "'-1'");
  refuses(HEADER "2000000000\n255 0 0 * 0 0 0 1\n", 9, 1, "a number", "end of file");
  refuses(HEADER "3000000000\n255 0 0 * 0 0 0 1\n", 7, 1, "an integer from 0", "'3000000000'");
  refuses(HEADER "1\n255 0 0 * 0 0 0 0\n", 8, 17, "greater than 0 (the radius)", "'0'");
  refuses(HEADER "1\n255 0 0 / 0 0 0 0 0 0\n", 8, 17, "a normal other than", "'0'");
  refuses(HEADER "1\n255 0 0 + 0 0 0 0 0 0\n", 8, 9, "a number, * or /", "'+'");
  refuses(HEADER "1\n5 0 0 0 0 2 1 / 0 0 0 0 0 1\n9 9 9\n0\n", 8, 11, "from 0 to 1 (ks)", "'2'");
  refuses(HEADER "1\n5 0 0 0 0 0 0 / 0 0 0 0 0 1\n9 9 9\n0\n", 8, 13, "the exponent", "'0'");
  refuses(HEADER "1\n1\n5 0 0 0 0 0 1 0 1 0 * 0 0 0 1\n9 9 9\n0\n", 9, 19, "n > 0", "'0'");
  refuses(HEADER "1.5\n1\n5 0 0 0 0 0 1 0 1 1 * 0 0 0 1\n9 9 9\n0\n", 7, 1, "integer", "'1.5'");
}

static void a_given_delivery_overrides(void) {
  const char *text = HEADER "0\n255 255 255\n0\n";
  ct_scene *scene;
  ct_fault fault;
  CHECK(ct_scene_parse(text, strlen(text), 1, &scene, &fault) == CT_ERR_SCENE);
  CHECK(fault.line == 8 && fault.column == 1);
  CHECK(ct_scene_parse(text, strlen(text), 2, &scene, &fault) == CT_OK);
  ct_scene_free(scene);
  CHECK(ct_scene_parse(text, strlen(text), 4, &scene, &fault) == CT_ERR_ARGUMENT);
}

int main(void) {
  deliveries_are_told_apart();
  real_files_are_read();
  faults_are_located();
  a_given_delivery_overrides();
  return 0;
}
