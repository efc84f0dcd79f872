/* Any number of threads and any band of rows give the same bits; a callback can end a frame. */
#include <string.h>

#include "check.h"
#include "crosstrace.h"
#include "test_options.h"

enum { ROWS = 45, COLUMNS = 61 };

static const char scene_text[] =
    "45 61\n0.02 1\n0 -6 1.5\n0 0 0.8\n0 0 1\n120 170 230\n4\n3\n"
    "220 220 220 0.2 0.7 0 1 0.2 0 1 / 0 0 0 0 0 1\n"
    "230 60 60 0.1 0.7 0.4 50 0.1 0 1 * -1.1 1 1 1\n"
    "30 30 30 0 0.1 0.5 200 0.1 0.8 1.5 * 0.3 -0.5 1 1\n"
    "255 255 255\n2\n150 150 150 -4 -5 6\n120 120 120 3 -2 5\n";

static double image[ROWS * COLUMNS * 3], other[ROWS * COLUMNS * 3];
static uint64_t tree[ROWS * COLUMNS], other_tree[ROWS * COLUMNS];

static int stop_at_once(void *user, uint64_t done, uint64_t total) {
  (void)done, (void)total;
  ++*(int *)user;
  return 1;
}

int main(void) {
  ct_scene *scene;
  ct_fault fault;
  CHECK(ct_scene_parse(scene_text, strlen(scene_text), 0, &scene, &fault) == CT_OK);
  ct_scene_view view = ct_scene_data(scene);
  ct_options *options = test_options();
  ct_outputs outputs = {.image = image, .tree = tree};
  ct_options_set_threads(options, 1);
  CHECK(ct_render(&view, options, &outputs, NULL, NULL, NULL) == CT_OK);
  for (unsigned n = 2; n <= 5; n++) {
    ct_outputs again = {.image = other, .tree = other_tree};
    memset(other, 0xff, sizeof other);
    ct_options_set_threads(options, n);
    CHECK(ct_render(&view, options, &again, NULL, NULL, NULL) == CT_OK);
    CHECK(memcmp(image, other, sizeof image) == 0);
    CHECK(memcmp(tree, other_tree, sizeof tree) == 0);
  }
  for (int64_t row = 0; row < ROWS; row += 7) {
    int64_t end = row + 7 < ROWS ? row + 7 : ROWS;
    ct_outputs band = {.image = other + row * COLUMNS * 3};
    ct_options_set_rows(options, row, end);
    CHECK(ct_render(&view, options, &band, NULL, NULL, NULL) == CT_OK);
  }
  CHECK(memcmp(image, other, sizeof image) == 0);

  /* A frame of hours ends when the callback asks for it. */
  int n_calls = 0;
  ct_outputs nothing = {0};
  view.v_res = view.h_res = 1 << 20;
  ct_options_set_rows(options, 0, 0);
  CHECK(ct_render(&view, options, &nothing, stop_at_once, &n_calls, NULL) == CT_ERR_CANCELLED);
  CHECK(n_calls == 1);
  ct_options_free(options);
  ct_scene_free(scene);
  return 0;
}
