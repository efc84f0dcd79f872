/* Certified streams: what they close holds the truth, as double-double knows it and as float128
 * traces it; every instruction set, thread count and order of pixels gives the same bits. */
#include <fenv.h>
#include <math.h>
#include <string.h>

#include "check.h"
#include "random.h"
#include "set_stream.h"

enum { USUAL_OBJECTS = 12, MOST_OBJECTS = 80, MOST_LIGHTS = 3, SIDE = 21, N_PIXELS = SIDE * SIDE };

static uint8_t kind[MOST_OBJECTS];
static double color[MOST_OBJECTS * 3], material[MOST_OBJECTS * CT_MATERIAL_COLUMNS];
static double geometry[MOST_OBJECTS * CT_GEOMETRY_COLUMNS], lights[MOST_LIGHTS * CT_LIGHT_COLUMNS];
static double image[N_PIXELS * 3];

/* What is known of a frame's pixels. */
typedef struct known {
  double lo[N_PIXELS * 3], hi[N_PIXELS * 3];
  uint8_t open[N_PIXELS];
} known;
static known first, again;

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
  v.n_objects = 1 + (size_t)(uniform() * (one_in(15) ? MOST_OBJECTS : USUAL_OBJECTS));
  v.n_lights = (size_t)(uniform() * (MOST_LIGHTS + 1));
  for (size_t i = 0; i < v.n_objects; i++) random_object(i, scale, away);
  for (size_t j = 0; j < v.n_lights; j++)
    for (size_t k = 0; k < 6; k++)
      lights[6 * j + k] = k < 3 ? floor(uniform_in(0, 256)) : coordinate(-5, 5) * scale + away;
  return v;
}

static void random_options(ct_options *options) {
  static const char *const settings[][2] = {
      {"epsilon", "1e-3"},    {"epsilon", "0"},         {"epsilon", "1e-9"},
      {"shadow_min", "1e-3"}, {"light_min", "1e-3"},    {"far", "7"},
      {"far", "1e7"},         {"index", "float32"},     {"nesting", "tracked"},
      {"nesting", "interiors"}, {"offset", "mitsuba"}};
  ct_fault fault;
  for (size_t i = 0; i < sizeof settings / sizeof *settings; i++)
    if (one_in(5))
      CHECK(ct_options_set(options, settings[i][0], settings[i][1], &fault) == CT_OK);
  if (one_in(4)) ct_options_set_effects(options, (unsigned)(uniform() * 256));
}

/* Rounding upward: by the stream for these options, every `step`-th pixel in batches of so many. */
static int enclose(const ct_frame *frame, int64_t step, int most, known *out) {
  const ct_set_stream *stream = ct_set_stream_for(frame);
  const atomic_int stop = 0;
  const ct_set_limits limits = {1, 1 << 16, &stop};
  void *world;
  if (!stream) return 0;
  memset(out, 0xff, sizeof *out);
  fesetround(FE_UPWARD);
  CHECK(stream->open(frame, &world) == CT_OK);
  for (int64_t begin = 0; begin < N_PIXELS; begin += most) {
    int64_t pixels[CT_SET_STREAM];
    ct_set_batch batch;
    int n = 0;
    /* step has no factor in common with N_PIXELS, so that every pixel comes up. */
    for (; n < most && begin + n < N_PIXELS; n++)
      pixels[n] = (begin + n) * step % N_PIXELS;
    stream->batch(world, pixels, n, &limits, &batch);
    for (int i = 0; i < n; i++) {
      out->open[pixels[i]] = batch.open[i];
      for (int k = 0; k < 3 && !batch.open[i]; k++) {
        out->lo[3 * pixels[i] + k] = batch.lo[k][i];
        out->hi[3 * pixels[i] + k] = batch.hi[k][i];
      }
    }
  }
  stream->close(world);
  fesetround(FE_TONEAREST);
  return 1;
}

static int64_t n_closed, n_checked, n_excused;

/* Truth: the scalar kernel in double-double, whose enclosures are some 1e-25 wide. */
static void holds_double_double(const ct_frame *frame, const known *k) {
  const atomic_int stop = 0;
  const ct_set_limits limits = {1, 1 << 16, &stop};
  void *witness;
  fesetround(ct_set_kernel_dd.rounding);
  CHECK(ct_set_kernel_dd.open(frame, 0, &witness) == CT_OK);
  for (int64_t i = (int64_t)(uniform() * 5); i < N_PIXELS; i += 5) {
    if (k->open[i]) continue;
    ct_set_result truth;
    ct_set_kernel_dd.pixel(witness, i / SIDE, i % SIDE, &limits, &truth);
    if (truth.status != CT_SET_DECIDED) continue;
    n_checked++;
    for (int64_t c = 0; c < 3; c++)
      CHECK(k->lo[3 * i + c] <= truth.hi[c] && truth.lo[c] <= k->hi[3 * i + c] &&
            k->lo[3 * i + c] <= k->hi[3 * i + c]);
  }
  fesetround(FE_TONEAREST);
  ct_set_kernel_dd.close(witness);
}

#if defined(__SIZEOF_FLOAT128__)
/* Whether all float128 can say of a pixel is that it is a toss-up: the tracer's value is then one
 * side of a tie that the streams know to be none, such as a ray parallel to a plane. */
static int is_open_in_float128(const ct_frame *frame, int64_t pixel) {
  const atomic_int stop = 0;
  const ct_set_limits limits = {1, 1 << 16, &stop};
  ct_set_result result;
  void *world;
  CHECK(ct_set_kernel_f128.open(frame, 0, &world) == CT_OK);
  fesetround(ct_set_kernel_f128.rounding);
  ct_set_kernel_f128.pixel(world, pixel / SIDE, pixel % SIDE, &limits, &result);
  fesetround(FE_TONEAREST);
  ct_set_kernel_f128.close(world);
  return result.status != CT_SET_DECIDED;
}

/* The tracer in float128, but for the rounding of its value to double. */
static void holds_float128(const ct_frame *frame, ct_options *options, const known *k) {
  ct_fault fault;
  ct_outputs outputs = {.image = image};
  CHECK(ct_options_set_precision(options, "f128", &fault) == CT_OK);
  CHECK(ct_render(&frame->view, options, &outputs, NULL, NULL, NULL) == CT_OK);
  for (int64_t i = 0; i < N_PIXELS * 3; i++) {
    if (k->open[i / 3]) continue;
    double slack = 0x1p-52 * fabs(image[i]) + 1e-30; /* its roundings, too */
    if (k->lo[i] - slack <= image[i] && image[i] <= k->hi[i] + slack) continue;
    CHECK(is_open_in_float128(frame, i / 3));
    n_excused++;
  }
}
#endif

/* Certification as a whole: some pixels, all of those that the scalar text closes among them. */
enum { N_SOME = 40 };

static void certify_some(const ct_scene_view *view, ct_options *options, unsigned n_threads,
                         const int64_t *pixels, double *lo, double *hi, uint8_t *class) {
  ct_certify_request request = {.pixels = pixels, .n_pixels = N_SOME, .tolerance = 1e-9};
  ct_enclosures out = {.lo = lo, .hi = hi, .pixel_class = class};
  ct_options_set_threads(options, n_threads);
  CHECK(ct_certify(view, options, &request, &out, NULL, NULL, NULL) == CT_OK);
}

static void certifies_as_much_as_scalar(const ct_frame *frame, const ct_scene_view *view,
                                        ct_options *options) {
  static double lo[3 * N_SOME], hi[3 * N_SOME], other_lo[3 * N_SOME], other_hi[3 * N_SOME];
  const atomic_int stop = 0;
  const ct_set_limits limits = {1, 1 << 16, &stop};
  int64_t pixels[N_SOME];
  uint8_t class[N_SOME], other_class[N_SOME];
  void *world;
  for (int i = 0; i < N_SOME; i++) pixels[i] = (int64_t)(uniform() * N_PIXELS);
  certify_some(view, options, 1, pixels, lo, hi, class);
  certify_some(view, options, 3, pixels, other_lo, other_hi, other_class);
  CHECK(memcmp(lo, other_lo, sizeof lo) == 0 && memcmp(hi, other_hi, sizeof hi) == 0);
  CHECK(memcmp(class, other_class, sizeof class) == 0);
  fesetround(FE_UPWARD);
  CHECK(ct_set_kernel_f64.open(frame, 0, &world) == CT_OK);
  for (int i = 0; i < N_SOME; i++) {
    ct_set_result r;
    ct_set_kernel_f64.pixel(world, pixels[i] / SIDE, pixels[i] % SIDE, &limits, &r);
    if (r.status != CT_SET_DECIDED) continue;
    double width = 0;
    for (int c = 0; c < 3; c++) {
      CHECK(lo[3 * i + c] <= r.hi[c] && r.lo[c] <= hi[3 * i + c]);
      width = fmax(width, r.hi[c] - r.lo[c]);
    }
    CHECK(class[i] == CT_CERTIFIED || !(width <= 1e-9));
  }
  ct_set_kernel_f64.close(world);
  fesetround(FE_TONEAREST);
}

int main(int argc, char **argv) {
  int n_scenes = argc > 2 ? atoi(argv[2]) : 150;
  if (argc > 3) random_state ^= (uint64_t)atoi(argv[3]) * UINT64_C(0x9e3779b97f4a7c15);
  for (int i = 0; i < n_scenes; i++) {
    ct_fault fault;
    ct_frame frame;
    ct_scene_view view = random_scene();
    if (ct_scene_check(&view, &fault) != CT_OK) continue;
    ct_options *options = ct_options_new();
    random_options(options);
    CHECK(ct_frame_open(&frame, &view, options) == CT_OK);
    if (enclose(&frame, 1, CT_SET_STREAM, &first)) {
      const char *set;
      for (size_t k = 0; (set = ct_instructions_name(k)) != NULL; k++) {
        CHECK(ct_options_set_instructions(options, set, &fault) == CT_OK);
        /* In another order, and alone or with few others, too: a pixel's bits are its own. */
        static const int sizes[] = {CT_SET_STREAM, 1, 9};
        CHECK(enclose(&frame, k % 2 ? 1 : 10, sizes[k % 3], &again));
        CHECK(memcmp(&first, &again, sizeof first) == 0);
      }
      for (size_t p = 0; p < N_PIXELS; p++) n_closed += !first.open[p];
      holds_double_double(&frame, &first);
#if defined(__SIZEOF_FLOAT128__)
      if (i % 4 == 0) holds_float128(&frame, options, &first);
#endif
      if (i % 10 == 0) certifies_as_much_as_scalar(&frame, &view, options);
    }
    ct_frame_close(&frame);
    ct_options_free(options);
  }
  CHECK(n_checked > n_scenes * 10 && n_excused * 10000 <= n_closed);
  if (argc > 2)
    printf("closed %lld, checked %lld, excused %lld\n", (long long)n_closed, (long long)n_checked,
           (long long)n_excused);
  return 0;
}
