/* Squares of a frame have the frame's bits, and a jittered frame those of any way of tracing it. */
#include <string.h>

#include "check.h"
#include "crosstrace.h"
#include "test_options.h"

enum { SIDE = 12, ACROSS = 4, DOWN = 3, COLUMNS = SIDE * ACROSS, ROWS = SIDE * DOWN };
enum { N_CELLS = 5 };

static const char scene_text[] =
    "36 48\n0.02 1\n0 -6 1.5\n0 0 0.8\n0 0 1\n120 170 230\n4\n3\n"
    "220 220 220 0.2 0.7 0 1 0.2 0 1 / 0 0 0 0 0 1\n"
    "230 60 60 0.1 0.7 0.4 50 0.1 0 1 * -1.1 1 1 1\n"
    "30 30 30 0 0.1 0.5 200 0.1 0.8 1.5 * 0.3 -0.5 1 1\n"
    "255 255 255\n2\n150 150 150 -4 -5 6\n120 120 120 3 -2 5\n";

static double image[ROWS * COLUMNS * 3], other[ROWS * COLUMNS * 3];
static double squares[N_CELLS * SIDE * SIDE * 3];
static uint64_t tree[ROWS * COLUMNS], square_tree[N_CELLS * SIDE * SIDE];

/* The last first, and one twice: every order is allowed. */
static const int64_t cells[N_CELLS] = {11, 0, 6, 6, 5};

static void cells_are_the_frames(const ct_scene_view *view, ct_options *options) {
  ct_outputs frame = {.image = image, .tree = tree};
  ct_outputs some = {.image = squares, .tree = square_tree};
  ct_stats stats;
  CHECK(ct_render(view, options, &frame, NULL, NULL, NULL) == CT_OK);
  CHECK(ct_render_cells(view, options, cells, N_CELLS, SIDE, &some, NULL, NULL, &stats) == CT_OK);
  CHECK(stats.n_primary == N_CELLS * SIDE * SIDE);
  for (size_t i = 0; i < N_CELLS; i++)
    for (size_t row = 0; row < SIDE; row++) {
      size_t top = (size_t)cells[i] / ACROSS * SIDE, left = (size_t)cells[i] % ACROSS * SIDE;
      size_t from = (top + row) * COLUMNS + left, to = (i * SIDE + row) * SIDE;
      CHECK(memcmp(squares + 3 * to, image + 3 * from, 3 * SIDE * sizeof *image) == 0);
      CHECK(memcmp(square_tree + to, tree + from, SIDE * sizeof *tree) == 0);
    }
}

static void what_does_not_fit_is_refused(const ct_scene_view *view, const ct_options *options) {
  static const int64_t none[1] = {ACROSS * DOWN}, before[1] = {-1};
  ct_outputs some = {.image = squares};
  ct_stats stats = {.n_primary = 7};
  CHECK(ct_render_cells(view, options, none, 1, SIDE, &some, NULL, NULL, NULL) == CT_ERR_ARGUMENT);
  CHECK(ct_render_cells(view, options, before, 1, SIDE, &some, NULL, NULL, NULL) ==
        CT_ERR_ARGUMENT);
  CHECK(ct_render_cells(view, options, cells, 1, 5, &some, NULL, NULL, NULL) == CT_ERR_ARGUMENT);
  CHECK(ct_render_cells(view, options, cells, 1, 0, &some, NULL, NULL, NULL) == CT_ERR_ARGUMENT);
  CHECK(ct_render_cells(view, options, NULL, 1, SIDE, &some, NULL, NULL, NULL) == CT_ERR_ARGUMENT);
  CHECK(ct_render_cells(view, options, NULL, 0, SIDE, &some, NULL, NULL, &stats) == CT_OK);
  CHECK(stats.n_primary == 0);
}

static void jitter_moves_every_ray_the_same_way_each_time(const ct_scene_view *view,
                                                          ct_options *options) {
  ct_outputs centred = {.image = image}, moved = {.image = other};
  ct_fault fault;
  ct_options_set_jitter(options, 3);
  CHECK(ct_render(view, options, &moved, NULL, NULL, NULL) == CT_OK);
  CHECK(memcmp(image, other, sizeof image) != 0);
  memcpy(image, other, sizeof image);
  ct_options_set_threads(options, 3);
  CHECK(ct_options_set_instructions(options, "scalar", &fault) == CT_OK);
  CHECK(ct_render(view, options, &moved, NULL, NULL, NULL) == CT_OK);
  CHECK(memcmp(image, other, sizeof image) == 0);
  ct_options_set_jitter(options, 4);
  CHECK(ct_render(view, options, &centred, NULL, NULL, NULL) == CT_OK);
  CHECK(memcmp(image, other, sizeof image) != 0);
}

int main(void) {
  ct_scene *scene;
  ct_fault fault;
  CHECK(ct_scene_parse(scene_text, strlen(scene_text), 0, &scene, &fault) == CT_OK);
  ct_scene_view view = ct_scene_data(scene);
  static const char *const precisions[] = {"f32", "f64", "f64c"};
  for (size_t i = 0; i < sizeof precisions / sizeof *precisions; i++) {
    ct_options *options = test_options();
    CHECK(ct_options_set_precision(options, precisions[i], &fault) == CT_OK);
    cells_are_the_frames(&view, options);
    what_does_not_fit_is_refused(&view, options);
    jitter_moves_every_ray_the_same_way_each_time(&view, options);
    ct_options_free(options);
  }
  ct_options *options = test_options();
  ct_certify_request request = {.tolerance = 1e-9};
  ct_enclosures nothing = {0};
  ct_options_set_jitter(options, 1);
  CHECK(ct_certify(&view, options, &request, &nothing, NULL, NULL, NULL) == CT_ERR_OPTION);
  ct_options_free(options);
  ct_scene_free(scene);
  return 0;
}
