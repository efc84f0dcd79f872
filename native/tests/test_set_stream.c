/* Certified streams: what they close holds the truth, as double-double knows it and as float128
 * traces it; every instruction set, thread count and order of pixels gives the same bits. */
#include <fenv.h>
#include <math.h>
#include <string.h>

#include "check.h"
#include "random.h"
#include "set_stream.h"

enum { MOST_OBJECTS = 12, MOST_LIGHTS = 3, SIDE = 21, N_PIXELS = SIDE * SIDE };

static uint8_t kind[MOST_OBJECTS];
static double color[MOST_OBJECTS * 3], material[MOST_OBJECTS * CT_MATERIAL_COLUMNS];
static double geometry[MOST_OBJECTS * CT_GEOMETRY_COLUMNS], lights[MOST_LIGHTS * CT_LIGHT_COLUMNS];
static double image[N_PIXELS * 3];
static double lo[N_PIXELS * 3], hi[N_PIXELS * 3], other_lo[N_PIXELS * 3], other_hi[N_PIXELS * 3];
static uint8_t class[N_PIXELS], other_class[N_PIXELS], level[N_PIXELS];

static int one_in(int n) { return uniform() * n < 1; }

/* Mostly any number; sometimes one that makes coordinates equal and sums exact. */
static double coordinate(double a, double b) {
  double x = uniform_in(a, b);
  return one_in(3) ? nearbyint(x) : one_in(3) ? nearbyint(x * 4) / 4 : x;
}

static void random_material(double *m) {
  static const double indices[] = {1, 1.5, 1.33, 0.7, 2.5, 1.0000001};
  m[CT_KA] = one_in(3) ? 0 : uniform();
  m[CT_KD] = one_in(4) ? 0 : uniform();
  m[CT_KS] = one_in(3) ? 0 : uniform();
  m[CT_ETA] = one_in(9) ? uniform_in(0.5, 40) : floor(exponential_in(1, 2000));
  m[CT_KR] = one_in(2) ? 0 : uniform_in(0, 0.9);
  m[CT_KT] = one_in(2) ? 0 : uniform_in(0, 0.9);
  m[CT_N] = one_in(2) ? indices[(int)(uniform() * 6)] : uniform_in(0.6, 2);
}

static void random_object(size_t i, double scale, double away) {
  double *g = geometry + i * CT_GEOMETRY_COLUMNS;
  for (int k = 0; k < 6; k++) g[k] = 0;
  for (int k = 0; k < 3; k++) color[3 * i + (size_t)k] = floor(uniform_in(0, 256));
  random_material(material + i * CT_MATERIAL_COLUMNS);
  kind[i] = one_in(4) ? CT_PLANE : CT_SPHERE;
  if (kind[i] == CT_SPHERE) {
    double r = one_in(8) ? exponential_in(1e-3, 1e4) : exponential_in(0.2, 2);
    for (int k = 0; k < 3; k++) g[k] = coordinate(-2, 2) * scale + away;
    if (r > 10) g[2] -= r * scale;
    /* Sometimes inside the one before: nested or intersecting. */
    if (i > 0 && kind[i - 1] == CT_SPHERE && one_in(3))
      for (int k = 0; k < 3; k++) g[k] = g[k - CT_GEOMETRY_COLUMNS] + 0.05 * scale * k;
    g[3] = r * scale;
    return;
  }
  if (one_in(2))
    g[3 + (int)(uniform() * 3)] = one_in(2) ? 1 : -2.5;
  else
    for (int k = 0; k < 3; k++) g[3 + k] = uniform_in(-1, 1);
  double length = sqrt(g[3] * g[3] + g[4] * g[4] + g[5] * g[5]);
  for (int k = 0; k < 3; k++) g[k] = away - g[3 + k] / length * coordinate(1.5, 4) * scale;
}

static ct_scene_view random_scene(void) {
  double scale = one_in(6) ? exponential_in(1e-6, 1e6) : 1, away = one_in(8) ? 1e3 * scale : 0;
  ct_scene_view v = {.delivery = one_in(6) ? 2 : 3, .v_res = SIDE, .h_res = SIDE,
                     .pixel_size = 0.05, .screen_distance = uniform_in(0.8, 2),
                     .max_depth = (int64_t)(uniform() * 7), .kind = kind, .color = color,
                     .material = material, .geometry = geometry, .lights = lights};
  for (int k = 0; k < 3; k++) {
    v.eye[k] = (one_in(2) && k == 0 ? 0 : coordinate(-6, 6)) * scale + away;
    v.target[k] = (one_in(2) ? 0 : coordinate(-1, 1)) * scale + away;
    v.background[k] = floor(uniform_in(0, 256));
    v.ambient[k] = floor(uniform_in(0, 256));
  }
  v.eye[1] -= 7 * scale;
  v.up[2] = 1;
  v.n_objects = 1 + (size_t)(uniform() * MOST_OBJECTS);
  v.n_lights = (size_t)(uniform() * (MOST_LIGHTS + 1));
  for (size_t i = 0; i < v.n_objects; i++) random_object(i, scale, away);
  for (size_t j = 0; j < v.n_lights; j++)
    for (size_t k = 0; k < 6; k++)
      lights[6 * j + k] = k < 3 ? floor(uniform_in(0, 256)) : coordinate(-5, 5) * scale + away;
  return v;
}

static void random_options(ct_options *options) {
  static const char *const settings[][2] = {
      {"epsilon", "1e-3"}, {"epsilon", "0"}, {"light_min", "1e-3"}, {"index", "float32"}, {"shadow_min", "1e-3"}, {"far", "7"},
      {"nesting", "tracked"}, {"nesting", "interiors"}, {"offset", "mitsuba"}, {"epsilon", "1e-9"}, {"far", "1e7"}};
  ct_fault fault;
  for (size_t i = 0; i < sizeof settings / sizeof *settings; i++)
    if (one_in(5))
      CHECK(ct_options_set(options, settings[i][0], settings[i][1], &fault) == CT_OK);
  if (one_in(4)) ct_options_set_effects(options, (unsigned)(uniform() * 256));
}

static ct_status certify(const ct_scene_view *view, ct_options *options, const char *instructions,
                         unsigned n_threads, double *l, double *h, uint8_t *c) {
  ct_fault fault;
  ct_certify_request request = {.tolerance = 1e-9};
  ct_enclosures out = {.lo = l, .hi = h, .pixel_class = c, .level = level};
  CHECK(ct_options_set_instructions(options, instructions, &fault) == CT_OK);
  ct_options_set_threads(options, n_threads);
  return ct_certify(view, options, &request, &out, NULL, NULL, NULL);
}

/* Pixels that the stream closes, all in one batch after another. */
static int64_t n_closed, n_checked;

/* The scalar kernel in double-double, whose enclosures are of 1e-25 where nothing is open. */
static void holds_double_double(const ct_frame *frame, const ct_set_stream *stream) {
  const atomic_int stop = 0;
  ct_set_limits limits = {1, 1 << 16, &stop};
  void *world, *witness;
  ct_set_batch batch;
  fesetround(FE_UPWARD);
  CHECK(stream->open(frame, &world) == CT_OK);
  fesetround(ct_set_kernel_dd.rounding);
  CHECK(ct_set_kernel_dd.open(frame, 0, &witness) == CT_OK);
  for (int64_t first = 0; first < N_PIXELS; first += CT_SET_STREAM) {
    int64_t pixels[CT_SET_STREAM];
    int n = 0;
    for (; n < CT_SET_STREAM && first + n < N_PIXELS; n++) pixels[n] = first + n;
    fesetround(FE_UPWARD);
    stream->batch(world, pixels, n, &limits, &batch);
    fesetround(ct_set_kernel_dd.rounding);
    for (int i = 0; i < n; i++) {
      if (batch.open[i]) continue;
      n_closed++;
      if ((pixels[i] * 7919) % 5) continue; /* one in five: this is the slow part */
      ct_set_result truth;
      ct_set_kernel_dd.pixel(witness, pixels[i] / SIDE, pixels[i] % SIDE, &limits, &truth);
      if (truth.status != CT_SET_DECIDED) continue;
      n_checked++;
      for (int k = 0; k < 3; k++) {
        CHECK(batch.lo[k][i] <= truth.hi[k] && truth.lo[k] <= batch.hi[k][i]);
        CHECK(batch.lo[k][i] <= batch.hi[k][i]);
      }
    }
  }
  fesetround(FE_UPWARD);
  stream->close(world);
  fesetround(FE_TONEAREST);
  ct_set_kernel_dd.close(witness);
}

/* Every certified pixel holds what float128 traces, but for the rounding of that to double. */
static void holds_float128(const ct_scene_view *view, ct_options *options) {
  ct_fault fault;
  ct_outputs outputs = {.image = image};
  if (ct_options_set_precision(options, "f128", &fault) != CT_OK) return;
  CHECK(ct_render(view, options, &outputs, NULL, NULL, NULL) == CT_OK);
  for (size_t i = 0; i < N_PIXELS * 3; i++) {
    if (class[i / 3] != CT_CERTIFIED) continue;
    double slack = 0x1p-52 * fabs(image[i]);
    CHECK(lo[i] - slack <= image[i] && image[i] <= hi[i] + slack);
  }
}

static void same_bits_as(const ct_scene_view *view, ct_options *options, const char *set,
                         unsigned n_threads) {
  CHECK(certify(view, options, set, n_threads, other_lo, other_hi, other_class) == CT_OK);
  CHECK(memcmp(lo, other_lo, sizeof lo) == 0 && memcmp(hi, other_hi, sizeof hi) == 0);
  CHECK(memcmp(class, other_class, sizeof class) == 0);
}

/* The scalar text gives other enclosures of the same values, and closes no pixel more. */
static void closes_as_much_as_scalar(const ct_scene_view *view, ct_options *options) {
  CHECK(certify(view, options, "scalar", 1, other_lo, other_hi, other_class) == CT_OK);
  for (size_t i = 0; i < N_PIXELS; i++) {
    if (other_class[i] == CT_CERTIFIED) CHECK(class[i] == CT_CERTIFIED);
    for (size_t k = 3 * i; k < 3 * i + 3; k++)
      CHECK(lo[k] <= other_hi[k] && other_lo[k] <= hi[k]);
  }
}

/* A pixel alone has the bits that it has among the others. */
static void same_bits_alone(const ct_scene_view *view, const ct_options *options) {
  int64_t pixels[3];
  double l[9], h[9];
  for (int k = 0; k < 3; k++) pixels[k] = (int64_t)(uniform() * N_PIXELS);
  ct_certify_request request = {.tolerance = 1e-9, .pixels = pixels, .n_pixels = 3};
  ct_enclosures out = {.lo = l, .hi = h};
  CHECK(ct_certify(view, options, &request, &out, NULL, NULL, NULL) == CT_OK);
  for (int k = 0; k < 3; k++) {
    CHECK(memcmp(l + 3 * k, lo + 3 * pixels[k], 3 * sizeof *l) == 0);
    CHECK(memcmp(h + 3 * k, hi + 3 * pixels[k], 3 * sizeof *h) == 0);
  }
}

int main(int argc, char **argv) {
  int n_scenes = argc > 2 ? atoi(argv[2]) : 60;
  if (argc > 3) random_state ^= (uint64_t)atoi(argv[3]) * UINT64_C(0x9e3779b97f4a7c15);
  for (int i = 0; i < n_scenes; i++) {
    ct_fault fault;
    ct_scene_view view = random_scene();
    if (ct_scene_check(&view, &fault) != CT_OK) continue;
    ct_options *options = ct_options_new();
    random_options(options);
    CHECK(certify(&view, options, "native", 1, lo, hi, class) == CT_OK);
    for (size_t k = 0; ct_instructions_name(k); k++)
      if (strcmp(ct_instructions_name(k), "scalar") != 0)
        same_bits_as(&view, options, ct_instructions_name(k), 1);
    closes_as_much_as_scalar(&view, options);
    same_bits_as(&view, options, "native", 3);
    same_bits_alone(&view, options);
    ct_frame frame;
    CHECK(ct_frame_open(&frame, &view, options) == CT_OK);
    const ct_set_stream *stream = ct_set_stream_for(&frame);
    if (stream) holds_double_double(&frame, stream);
    ct_frame_close(&frame);
    if (i % 4 == 0) holds_float128(&view, options);
    ct_options_free(options);
  }
  CHECK(n_checked > n_scenes * 10);
  if (argc > 2) printf("closed %lld, of which checked %lld\n", (long long)n_closed, (long long)n_checked);
  return 0;
}
