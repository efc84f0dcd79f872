/* Every precision of the ladder: names, the same bits whatever the threads and
 * the processor's instruction sets, depth, rounding modes. */
#include <math.h>
#include <string.h>

#include "check.h"
#include "crosstrace.h"
#include "kernel.h"
#include "test_options.h"

enum { SIDE = 33, N = SIDE * SIDE };

/* A mirror, glass and a fractional exponent over a plane. */
static const char scene_text[] =
    "33 33\n0.03 1\n0 -6 1.5\n0 0 0.8\n0 0 1\n120 170 230\n4\n3\n"
    "220 220 220 0.2 0.7 0 1 0.2 0 1 / 0 0 0 0 0 1\n"
    "230 60 60 0.1 0.7 0.4 50.5 0.1 0 1 * -1.1 1 1 1\n"
    "30 30 30 0 0.1 0.5 200 0.1 0.8 1.5 * 0.3 -0.5 1 1\n"
    "255 255 255\n2\n150 150 150 -4 -5 6\n120 120 120 3 -2 5\n";

/* Two mirrors that face each other, and light only at the last bounce's end. */
static const char deep_text[] =
    "1 1\n1 1\n0 0 5\n0 0 0\n0 1 0\n0 0 51\n99999\n2\n0 0 0 0 0 0 1 1 0 1 / 0 0 -1 0 0 1\n"
    "0 0 0 0 0 0 1 1 0 1 / 0 0 9 0 0 -1\n0 0 0\n0\n";

typedef struct frame_result {
  double image[3 * N], low[3 * N];
  uint64_t tree[N];
} frame_result;

static frame_result narrow, one, other;

static ct_scene *read_scene(const char *text) {
  ct_scene *scene;
  ct_fault fault;
  CHECK(ct_scene_parse(text, strlen(text), 0, &scene, &fault) == CT_OK);
  return scene;
}

static ct_status render_capped(const char *text, const char *precision, const char *rounding,
                               const char *most, unsigned n_threads, frame_result *result) {
  ct_fault fault;
  ct_scene *scene = read_scene(text);
  ct_scene_view view = ct_scene_data(scene);
  ct_options *options = test_options();
  CHECK(ct_options_set_precision(options, precision, &fault) == CT_OK);
  CHECK(ct_options_set_rounding(options, rounding, &fault) == CT_OK);
  if (most) CHECK(ct_options_set_instructions(options, most, &fault) == CT_OK);
  CHECK(ct_options_set(options, "exhausted", "background", &fault) == CT_OK);
  ct_options_set_threads(options, n_threads);
  memset(result, 0xff, sizeof *result);
  ct_outputs out = {.image = result->image, .image_low = result->low, .tree = result->tree};
  ct_status status = ct_render(&view, options, &out, NULL, NULL, NULL);
  ct_options_free(options);
  ct_scene_free(scene);
  return status;
}

static ct_status render(const char *text, const char *precision, const char *rounding,
                        unsigned n_threads, frame_result *result) {
  return render_capped(text, precision, rounding, NULL, n_threads, result);
}

static void names_are_listed(void) {
  const char *first[] = {"f32", "f64", "f64c"};
  ct_fault fault;
  ct_options *options = test_options();
  for (size_t i = 0; i < 3; i++) CHECK(strcmp(ct_precision_name(i), first[i]) == 0);
  size_t n = 0;
  while (ct_precision_name(n)) n++;
  CHECK(n >= 4 && n <= 6 && ct_precision_name(n + 1) == NULL);
  CHECK(ct_options_set_precision(options, "f16", &fault) == CT_ERR_OPTION);
  CHECK(strncmp(fault.expected, "f32|f64|f64c|", 13) == 0 && strcmp(fault.found, "f16") == 0);
  CHECK(ct_options_set_rounding(options, "sideways", &fault) == CT_ERR_OPTION);
  CHECK(strcmp(fault.expected, "nearest|up|down|zero") == 0);
  ct_options_free(options);
}

/* Wider than double: the low part is there, small, and of use. */
static void precisions_agree(const char *name) {
  static frame_result wide;
  const char *widest = name;
  for (size_t i = 0; ct_precision_name(i); i++) widest = ct_precision_name(i);
  CHECK(render(scene_text, widest, "nearest", 2, &wide) == CT_OK);
  CHECK(render(scene_text, name, "nearest", 1, &one) == CT_OK);
  CHECK(render(scene_text, name, "nearest", 3, &other) == CT_OK);
  CHECK(memcmp(&one, &other, sizeof one) == 0);
  int is_float = strcmp(name, "f32") == 0, n_trees = 0;
  double worst = 0;
  for (size_t i = 0; i < 3 * N; i++) {
    CHECK(fabs(one.low[i]) <= 0x1p-53 * fabs(one.image[i]));
    double error = fabs((one.image[i] - wide.image[i]) + (one.low[i] - wide.low[i]));
    n_trees += i % 3 == 0 && one.tree[i / 3] != wide.tree[i / 3];
    if (error > worst && one.tree[i / 3] == wide.tree[i / 3]) worst = error;
  }
  printf("%-5s worst error %.1e, other trees %d\n", name, worst, n_trees);
  CHECK(n_trees <= (is_float ? N / 100 : 0));
  CHECK(worst <= (is_float ? 1e-3 : strncmp(name, "f64", 3) == 0 ? 1e-12
                                : strcmp(name, "f80") == 0      ? 1e-15
                                                                : 1e-27));
}

static void the_deepest_tree_has_stack(const char *name) {
  CHECK(render(deep_text, name, "nearest", 1, &one) == CT_OK);
  CHECK(one.image[0] == 0 && fabs(one.image[2] - 0.2) < 1e-6);
}

static void modes_change_last_digits(const char *name) {
  static const char *const modes[] = {"up", "down", "zero"};
  int takes = strcmp(name, "f32") == 0 || strcmp(name, "f64") == 0 || strcmp(name, "f80") == 0;
  double allowed = strcmp(name, "f32") == 0 ? 1e-2 : 1e-11;
  CHECK(render(scene_text, name, "nearest", 2, &narrow) == CT_OK);
  for (size_t m = 0; m < 3; m++) {
    ct_status status = render(scene_text, name, modes[m], 2, &one);
    CHECK(status == (takes ? CT_OK : CT_ERR_OPTION));
    if (!takes) continue;
    CHECK(render(scene_text, name, modes[m], 1, &other) == CT_OK);
    CHECK(memcmp(&one, &other, sizeof one) == 0);
    CHECK(memcmp(&one, &narrow, sizeof one) != 0);
    int n_off = 0;
    for (size_t i = 0; i < 3 * N; i++)
      n_off += !(fabs(one.image[i] - narrow.image[i]) <= allowed);
    CHECK(n_off <= (strcmp(name, "f32") == 0 ? 3 * N / 100 : 0));
  }
  /* The mode ends with the frame. */
  CHECK(render(scene_text, name, "nearest", 2, &one) == CT_OK);
  CHECK(memcmp(&one, &narrow, sizeof one) == 0);
}

/* Index of a precision in the ladder. */
static size_t index_of(const char *name) {
  for (size_t i = 0; ct_precision_name(i); i++)
    if (strcmp(ct_precision_name(i), name) == 0) return i;
  CHECK(0);
  return 0;
}

static void instruction_sets_change_no_bit(const char *name) {
  CHECK(render_capped(scene_text, name, "nearest", "native", 2, &one) == CT_OK);
  for (size_t i = 0; ct_instructions_name(i); i++) {
    const char *most = ct_instructions_name(i);
    CHECK(render_capped(scene_text, name, "nearest", most, 2, &other) == CT_OK);
    CHECK(memcmp(&one, &other, sizeof one) == 0);
  }
}

static void a_cap_on_instruction_sets_is_heeded(void) {
  ct_fault fault;
  ct_options *options = ct_options_new();
  CHECK(strcmp(ct_instructions_name(0), "scalar") == 0 && ct_instructions_name(5) == NULL);
  CHECK(ct_options_set_instructions(options, "avx512", &fault) == CT_OK);
  CHECK(ct_options_set_instructions(options, "sse9", &fault) == CT_ERR_OPTION);
  CHECK(strcmp(fault.expected, "scalar|generic|fma|avx2|avx512|native") == 0);
  CHECK(ct_instructions_usable(CT_INSTRUCTIONS_GENERIC) == CT_INSTRUCTIONS_GENERIC);
#if defined(CT_HAVE_FMA_UNITS)
  int has_fma = ct_instructions_name(2) != NULL;
  CHECK(has_fma == (__builtin_cpu_supports("fma") != 0));
  for (int k = 0; k < 2; k++) {
    size_t i = index_of(k ? "dd" : "f64c");
    const ct_kernel *plain = ct_precision_kernel(i, CT_INSTRUCTIONS_GENERIC);
    for (int cap = CT_INSTRUCTIONS_FMA; cap <= CT_INSTRUCTIONS_NATIVE; cap++)
      CHECK((ct_precision_kernel(i, (ct_instructions)cap) != plain) == has_fma);
  }
#endif
  ct_options_free(options);
}

int main(void) {
  names_are_listed();
  for (size_t i = 0; ct_precision_name(i); i++) {
    precisions_agree(ct_precision_name(i));
    the_deepest_tree_has_stack(ct_precision_name(i));
    modes_change_last_digits(ct_precision_name(i));
    instruction_sets_change_no_bit(ct_precision_name(i));
  }
  a_cap_on_instruction_sets_is_heeded();
  return 0;
}
