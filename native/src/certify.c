/* Certified pixels: an enclosure of the real-arithmetic value, or undecidable with its reason.
 *
 * Pixels go through intervals in double: in vectors where the frame allows it (set_stream.h), then
 * those that this leaves open one by one. What is then left goes through double-double, and what is
 * left of that through float128. Open means: an enclosure wider than the tolerance, a decision whose
 * outcomes differ by more than it, or a quantity too wide to go on with.
 */
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "kernel.h"
#include "machine.h"
#include "parallel.h"
#include "set.h"
#include "set_stream.h"
#include "tree.h"

enum { N_LEVELS = 3, CHUNK = CT_SET_STREAM, RAYS_PER_PIXEL = 1 << 20 };
/* Bytes of stack for one level of the recursion of the widest kernel. */
enum { SET_STACK_PER_LEVEL = 32768, SET_STACK_LEVELS = 4096 };

/* The kernel of a level, NULL where this platform has none. */
static const ct_set_kernel *kernel_of(int level, ct_instructions cap) {
  (void)cap;
  if (level == 0) return &ct_set_kernel_f64;
#if defined(CT_HAVE_FMA_UNITS)
  /* The same bits, faster. */
  if (level == 1 && ct_instructions_usable(cap) >= CT_INSTRUCTIONS_FMA)
    return &ct_set_kernel_dd_fma;
#endif
  if (level == 1) return &ct_set_kernel_dd;
#if defined(__SIZEOF_FLOAT128__)
  if (level == 2) return &ct_set_kernel_f128;
#endif
  return NULL;
}

static const int outcomes_followed[N_LEVELS] = {1, 16, 256};
/* With rounding let in, more cost much and decide little: of the values behind glass that 256 prove
 * wrong under four faults, 32 prove 98 %, in a quarter of the time. */
enum { OUTCOMES_UNDER_TEST = 32 };

typedef struct job {
  const ct_frame *frame;
  const ct_certify_request *request;
  const ct_enclosures *out;
  const ct_set_kernel *kernels[N_LEVELS];
  const void *worlds[N_LEVELS];
  int n_levels;
  const ct_set_stream *stream; /* NULL: every pixel on its own */
  void *stream_world;
  atomic_int stop;
  atomic_uint_fast64_t n_closed[N_LEVELS];
} job;

static double width_of(const ct_set_result *r) {
  double width = 0;
  for (int k = 0; k < 3; k++) width = fmax(width, r->hi[k] - r->lo[k]);
  return width;
}

static int has_value(const ct_set_result *r) {
  return r->status == CT_SET_DECIDED || r->status == CT_SET_AMBIGUOUS;
}

static ct_certify_class class_of(const ct_set_result *r, double tolerance) {
  if (has_value(r) && width_of(r) <= tolerance) return CT_CERTIFIED;
  if (r->status == CT_SET_AMBIGUOUS) return CT_UNDECIDABLE_EDGE;
  return r->status == CT_SET_BUDGET ? CT_UNDECIDABLE_BUDGET : CT_UNDECIDABLE_PRECISION;
}

static void store(const job *j, uint64_t at, const ct_set_result *r, ct_certify_class class,
                  int level) {
  const ct_enclosures *out = j->out;
  for (int k = 0; k < 3; k++) {
    if (out->lo) out->lo[3 * at + (size_t)k] = has_value(r) ? r->lo[k] : -(double)INFINITY;
    if (out->hi) out->hi[3 * at + (size_t)k] = has_value(r) ? r->hi[k] : (double)INFINITY;
  }
  if (out->pixel_class) out->pixel_class[at] = (uint8_t)class;
  if (out->level) out->level[at] = (uint8_t)level;
  if (out->decision) out->decision[at] = (uint8_t)r->first.kind;
  if (out->depth) out->depth[at] = (int32_t)r->first.depth;
  if (out->object) out->object[at] = (int32_t)r->first.object;
  if (out->n_alternatives) out->n_alternatives[at] = (uint8_t)r->n_alternatives;
  if (out->alternatives) {
    double *to = out->alternatives + at * CT_ALTERNATIVES * 6;
    memset(to, 0, CT_ALTERNATIVES * 6 * sizeof *to);
    memcpy(to, r->alternatives, r->n_alternatives * sizeof *r->alternatives);
  }
}

static int64_t pixel_at(const job *j, uint64_t at) {
  return j->request->pixels ? j->request->pixels[at] : (int64_t)at;
}

/* Called in the rounding mode of the first level, and leaves it so. */
static void certify_pixel(job *j, uint64_t at, uint64_t n_closed[N_LEVELS]) {
  const ct_certify_request *q = j->request;
  int64_t h_res = j->frame->view.h_res;
  int64_t pixel = pixel_at(j, at);
  ct_set_result result; /* its alternatives are filled as far as they are counted */
  result.status = CT_SET_PRECISION;
  ct_certify_class class = CT_UNDECIDABLE_PRECISION;
  int level = 0;
  for (; level < j->n_levels; level++) {
    int is_last = level == j->n_levels - 1;
    int n_outcomes = q->kappa > 0 ? OUTCOMES_UNDER_TEST
                     : is_last  ? outcomes_followed[N_LEVELS - 1]
                                : outcomes_followed[level];
    ct_set_limits limits = {n_outcomes, RAYS_PER_PIXEL, &j->stop};
    if (level > 0) fesetround(j->kernels[level]->rounding);
    j->kernels[level]->pixel(j->worlds[level], pixel / h_res, pixel % h_res, &limits, &result);
    if (level > 0) fesetround(j->kernels[0]->rounding);
    class = class_of(&result, q->tolerance);
    if (class == CT_CERTIFIED || is_last) break;
  }
  if (class == CT_CERTIFIED) n_closed[level]++;
  store(j, at, &result, class, level);
}

/* Stores a batch as if all of it were certified, array by array: one by one took a twentieth of the
 * time. */
static void store_batch(const job *j, uint64_t begin, size_t n, const ct_set_batch *batch) {
  const ct_enclosures *out = j->out;
  for (size_t i = 0; i < n; i++)
    for (size_t k = 0; k < 3; k++) {
      if (out->lo) out->lo[3 * (begin + i) + k] = batch->lo[k][i];
      if (out->hi) out->hi[3 * (begin + i) + k] = batch->hi[k][i];
    }
  if (out->pixel_class) memset(out->pixel_class + begin, CT_CERTIFIED, n);
  if (out->level) memset(out->level + begin, 0, n);
  if (out->decision) memset(out->decision + begin, CT_DECISION_NONE, n);
  if (out->n_alternatives) memset(out->n_alternatives + begin, 1, n);
  if (out->depth) memset(out->depth + begin, 0, n * sizeof *out->depth);
  for (size_t i = 0; out->object && i < n; i++) out->object[begin + i] = -1;
  for (size_t i = 0; out->alternatives && i < n; i++) {
    double *to = out->alternatives + (begin + i) * CT_ALTERNATIVES * 6;
    memset(to, 0, CT_ALTERNATIVES * 6 * sizeof *to);
    for (int k = 0; k < 3; k++) {
      to[k] = batch->lo[k][i];
      to[3 + k] = batch->hi[k][i];
    }
  }
}

/* Certifies those pixels of a chunk that need no decision looked into; says which are left. */
static void certify_batch(job *j, uint64_t begin, uint64_t end, uint64_t n_closed[N_LEVELS],
                          unsigned char open[CHUNK]) {
  int64_t pixels[CHUNK] = {0};
  ct_set_batch batch;
  ct_set_limits limits = {outcomes_followed[0], RAYS_PER_PIXEL, &j->stop};
  for (uint64_t at = begin; at < end; at++) pixels[at - begin] = pixel_at(j, at);
  j->stream->batch(j->stream_world, pixels, (int)(end - begin), &limits, &batch);
  memcpy(open, batch.open, CHUNK);
  for (uint64_t i = 0; i < end - begin; i++) {
    for (int k = 0; k < 3; k++) {
      double lo = batch.lo[k][i], hi = batch.hi[k][i];
      /* Also where one is no number. */
      if (!(lo <= hi) || !(hi - lo <= j->request->tolerance)) open[i] = 1;
    }
    n_closed[0] += !open[i];
  }
  store_batch(j, begin, end - begin, &batch);
}

static void run_chunk(void *argument, void *state, uint64_t begin, uint64_t end) {
  job *j = argument;
  uint64_t n_closed[N_LEVELS] = {0};
  (void)state;
  /* Changing the mode costs as much as a pixel of a flat scene, so once a chunk. */
  fesetround(j->kernels[0]->rounding);
  unsigned char open[CHUNK];
  memset(open, 1, sizeof open);
  if (j->stream) certify_batch(j, begin, end, n_closed, open);
  for (uint64_t at = begin; at < end; at++) {
    if (!open[at - begin]) continue;
    if (atomic_load_explicit(&j->stop, memory_order_relaxed)) break;
    certify_pixel(j, at, n_closed);
  }
  for (int k = 0; k < N_LEVELS; k++) atomic_fetch_add(&j->n_closed[k], n_closed[k]);
  fesetround(FE_TONEAREST);
}

static ct_status check_request(const ct_scene_view *view, const ct_certify_request *q) {
  int64_t n_pixels = view->v_res * view->h_res;
  if (!(q->kappa >= 0) || !(q->tolerance >= 0)) return CT_ERR_ARGUMENT;
  for (uint64_t i = 0; q->pixels && i < q->n_pixels; i++)
    if (q->pixels[i] < 0 || q->pixels[i] >= n_pixels) return CT_ERR_ARGUMENT;
  return CT_OK;
}

ct_status ct_certify(const ct_scene_view *view, const ct_options *options,
                     const ct_certify_request *request, const ct_enclosures *out,
                     ct_progress progress, void *user, ct_certify_stats *stats) {
  if (!view || !options || !request || !out || check_request(view, request))
    return CT_ERR_ARGUMENT;
  if (options->choice[CT_OFFSET] == CT_OFFSET_BOUND || options->jitter) return CT_ERR_OPTION;
  ct_machine_state caller = ct_machine_enter();
  ct_frame frame;
  ct_status status = ct_frame_open(&frame, view, options);
  if (!status) status = ct_frame_sort(&frame, progress, user);
  if (status) {
    ct_machine_leave(caller);
    return status;
  }
  job j = {.frame = &frame, .request = request, .out = out};
  /* What a rounding renderer may return is as wide in any type. */
  int n_wanted = request->kappa > 0 ? 1 : N_LEVELS;
  const ct_set_kernel *kernel;
  while (!status && j.n_levels < n_wanted &&
         (kernel = kernel_of(j.n_levels, options->instructions)) != NULL) {
    void *world = NULL;
    fesetround(kernel->rounding);
    status = kernel->open(&frame, request->kappa, &world);
    fesetround(FE_TONEAREST);
    if (status) break;
    j.kernels[j.n_levels] = kernel;
    j.worlds[j.n_levels++] = world;
  }
  if (!status && !(request->kappa > 0) && (j.stream = ct_set_stream_for(&frame)) != NULL) {
    fesetround(FE_UPWARD);
    status = j.stream->open(&frame, &j.stream_world);
    fesetround(FE_TONEAREST);
  }
  if (!status) {
    uint64_t n = request->pixels ? request->n_pixels : (uint64_t)(view->v_res * view->h_res);
    int64_t depth = frame.max_depth < SET_STACK_LEVELS ? frame.max_depth : SET_STACK_LEVELS;
    ct_work work = {.run = run_chunk, .job = &j, .n_items = n, .chunk = CHUNK,
                    .stack_bytes = ((size_t)1 << 20) + (size_t)(depth + 2) * SET_STACK_PER_LEVEL,
                    .stop = &j.stop};
    status = ct_parallel(&work, options->n_threads, progress, user, NULL);
  }
  if (stats)
    for (int k = 0; k < N_LEVELS; k++) stats->n_closed[k] = atomic_load(&j.n_closed[k]);
  for (int k = 0; k < j.n_levels; k++) j.kernels[k]->close((void *)(uintptr_t)j.worlds[k]);
  if (j.stream_world) j.stream->close(j.stream_world);
  ct_frame_close(&frame);
  ct_machine_leave(caller);
  return status;
}
