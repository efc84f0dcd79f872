/* Rendering a frame: tiles handed out to threads, results written where the caller wants them.
 *
 * Every pixel is traced alone and written once, so the bits do not depend on which thread took
 * which tile. The calling thread only waits, wakes every 50 ms to call back, and so can end a frame
 * at any size within the time of one ray.
 */
#define _GNU_SOURCE
#include <pthread.h>
#include <sched.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "kernel.h"
#include "machine.h"

enum { TILE_SIDE = 16, MAX_THREADS = 256 };

/* AddressSanitizer pads every variable of a frame. */
#if defined(__SANITIZE_ADDRESS__)
enum { STACK_FACTOR = 4 };
#else
enum { STACK_FACTOR = 1 };
#endif

typedef struct job {
  const ct_kernel *kernel;
  const void *world;
  const ct_scene_view *view;
  const ct_outputs *out;
  int64_t row_begin, row_end, tiles_across;
  uint64_t n_tiles;
  int rounding; /* of fesetround */
  ct_shared shared;
  atomic_uint_fast64_t next_tile, pixels_done;
  pthread_mutex_t lock;
  pthread_cond_t finished;
  unsigned n_running;
  ct_stats totals;
} job;

void ct_pixel_report(ct_pixel *pixel) {
  ct_shared *shared = pixel->shared;
  uint64_t used = atomic_fetch_add(&shared->rays_used, pixel->n_unreported) + pixel->n_unreported;
  pixel->n_unreported = 0;
  if (used > shared->ray_budget) {
    int running = CT_OK;
    atomic_compare_exchange_strong(&shared->stop, &running, CT_ERR_BUDGET);
  }
}

uint64_t ct_max_tree_depth(void) { return CT_MAX_TREE_DEPTH; }

static void store(const job *j, size_t at, const ct_pixel *p) {
  const ct_outputs *out = j->out;
  if (out->image) memcpy(out->image + 3 * at, p->color, sizeof p->color);
  if (out->image_low) memcpy(out->image_low + 3 * at, p->color_low, sizeof p->color_low);
  if (out->object) out->object[at] = p->object;
  if (out->t_world) out->t_world[at] = p->t_world;
  if (out->normal) memcpy(out->normal + 3 * at, p->normal, sizeof p->normal);
  if (out->tree) out->tree[at] = p->tree;
  if (out->rays) out->rays[at] = p->n_rays;
  if (out->contributions)
    memcpy(out->contributions + at * CT_CONTRIBUTIONS * 3, p->contributions,
           sizeof p->contributions);
}

static void render_tile(job *j, uint64_t tile, ct_pixel *pixel) {
  int64_t h_res = j->view->h_res;
  int64_t top = j->row_begin + (int64_t)(tile / (uint64_t)j->tiles_across) * TILE_SIDE;
  int64_t left = (int64_t)(tile % (uint64_t)j->tiles_across) * TILE_SIDE;
  int64_t bottom = top + TILE_SIDE < j->row_end ? top + TILE_SIDE : j->row_end;
  int64_t right = left + TILE_SIDE < h_res ? left + TILE_SIDE : h_res;
  for (int64_t row = top; row < bottom; row++)
    for (int64_t column = left; column < right; column++) {
      pixel->n_rays = 0;
      pixel->tree = 0;
      j->kernel->pixel(j->world, row, column, pixel);
      if (atomic_load_explicit(&j->shared.stop, memory_order_relaxed)) return;
      store(j, (size_t)(row - j->row_begin) * (size_t)h_res + (size_t)column, pixel);
    }
  atomic_fetch_add(&j->pixels_done, (uint64_t)(right - left) * (uint64_t)(bottom - top));
}

static void *run_thread(void *argument) {
  job *j = argument;
  ct_machine_state state = ct_machine_enter();
  const ct_outputs *out = j->out;
  ct_pixel pixel = {.shared = &j->shared,
                    .wants_contributions = out->contributions != NULL,
                    .wants_hit = out->object || out->t_world || out->normal};
  fesetround(j->rounding);
  for (;;) {
    uint64_t tile = atomic_fetch_add(&j->next_tile, 1);
    if (tile >= j->n_tiles || atomic_load(&j->shared.stop)) break;
    render_tile(j, tile, &pixel);
  }
  ct_pixel_report(&pixel);
  ct_machine_leave(state);
  pthread_mutex_lock(&j->lock);
  j->totals.n_shadow += pixel.n_shadow;
  j->totals.n_reflected += pixel.n_reflected;
  j->totals.n_refracted += pixel.n_refracted;
  if (--j->n_running == 0) pthread_cond_signal(&j->finished);
  pthread_mutex_unlock(&j->lock);
  return NULL;
}

static unsigned count_cores(void) {
#if defined(__linux__)
  cpu_set_t allowed;
  if (sched_getaffinity(0, sizeof allowed, &allowed) == 0) return (unsigned)CPU_COUNT(&allowed);
#endif
  long n = sysconf(_SC_NPROCESSORS_ONLN);
  return n > 0 ? (unsigned)n : 1;
}

static void wait_for_threads(job *j, ct_progress progress, void *user) {
  uint64_t total = (uint64_t)(j->row_end - j->row_begin) * (uint64_t)j->view->h_res;
  pthread_mutex_lock(&j->lock);
  while (j->n_running > 0) {
    struct timespec until;
    clock_gettime(CLOCK_REALTIME, &until);
    until.tv_nsec += 50000000;
    until.tv_sec += until.tv_nsec / 1000000000;
    until.tv_nsec %= 1000000000;
    pthread_cond_timedwait(&j->finished, &j->lock, &until);
    if (!progress || j->n_running == 0) continue;
    pthread_mutex_unlock(&j->lock);
    if (progress(user, atomic_load(&j->pixels_done), total)) {
      int running = CT_OK;
      atomic_compare_exchange_strong(&j->shared.stop, &running, CT_ERR_CANCELLED);
    }
    pthread_mutex_lock(&j->lock);
  }
  pthread_mutex_unlock(&j->lock);
}

static ct_status run_job(job *j, unsigned n_threads, int64_t depth, ct_progress progress,
                         void *user) {
  pthread_t threads[MAX_THREADS];
  pthread_attr_t attributes;
  unsigned n_started = 0;
  if (depth > CT_MAX_TREE_DEPTH) depth = CT_MAX_TREE_DEPTH;
  if (pthread_attr_init(&attributes)) return CT_ERR_THREAD;
  size_t stack = (size_t)1 << 20, per_level = j->kernel->stack_per_level * STACK_FACTOR;
  pthread_attr_setstacksize(&attributes, stack + (size_t)(depth + 2) * per_level);
  j->n_running = n_threads;
  while (n_started < n_threads &&
         pthread_create(&threads[n_started], &attributes, run_thread, j) == 0)
    n_started++;
  pthread_attr_destroy(&attributes);
  if (n_started < n_threads) {
    /* Fewer threads than wished for still render the frame; none cannot. */
    pthread_mutex_lock(&j->lock);
    j->n_running -= n_threads - n_started;
    pthread_mutex_unlock(&j->lock);
    if (n_started == 0) return CT_ERR_THREAD;
  }
  wait_for_threads(j, progress, user);
  for (unsigned i = 0; i < n_started; i++) pthread_join(threads[i], NULL);
  j->totals.n_threads = n_started;
  return (ct_status)atomic_load(&j->shared.stop);
}

static const int rounding_modes[] = {[CT_ROUND_NEAREST] = FE_TONEAREST,
                                     [CT_ROUND_UP] = FE_UPWARD,
                                     [CT_ROUND_DOWN] = FE_DOWNWARD,
                                     [CT_ROUND_ZERO] = FE_TOWARDZERO};

ct_status ct_render(const ct_scene_view *view, const ct_options *options,
                    const ct_outputs *outputs, ct_progress progress, void *user,
                    ct_stats *stats) {
  if (!view || !options || !outputs) return CT_ERR_ARGUMENT;
  int64_t end = options->row_end ? options->row_end : view->v_res;
  if (options->row_begin < 0 || options->row_begin >= end || end > view->v_res)
    return CT_ERR_ARGUMENT;
  const ct_kernel *kernel = ct_precision_kernel(options->precision);
  if (options->rounding != CT_ROUND_NEAREST && !kernel->takes_rounding) return CT_ERR_OPTION;
  ct_machine_state caller = ct_machine_enter();
  ct_frame frame;
  void *world = NULL;
  ct_status status = ct_frame_open(&frame, view, options);
  if (!status) {
    status = kernel->open(&frame, &world);
    if (!status) {
      int64_t across = (view->h_res + TILE_SIDE - 1) / TILE_SIDE;
      int64_t down = (end - options->row_begin + TILE_SIDE - 1) / TILE_SIDE;
      uint64_t n_tiles = (uint64_t)across * (uint64_t)down;
      unsigned n_threads = options->n_threads ? options->n_threads : count_cores();
      if (n_threads > MAX_THREADS) n_threads = MAX_THREADS;
      if (n_threads > n_tiles) n_threads = (unsigned)n_tiles;
      job j = {.kernel = kernel, .world = world, .view = view, .out = outputs,
               .rounding = rounding_modes[options->rounding],
               .row_begin = options->row_begin, .row_end = end, .tiles_across = across,
               .n_tiles = n_tiles, .shared = {.ray_budget = options->ray_budget},
               .lock = PTHREAD_MUTEX_INITIALIZER, .finished = PTHREAD_COND_INITIALIZER};
      status = run_job(&j, n_threads, frame.max_depth, progress, user);
      if (stats && !status) {
        *stats = j.totals;
        stats->n_primary = (uint64_t)(end - options->row_begin) * (uint64_t)view->h_res;
      }
      pthread_cond_destroy(&j.finished);
      pthread_mutex_destroy(&j.lock);
      kernel->close(world);
    }
    ct_frame_close(&frame);
  }
  ct_machine_leave(caller);
  return status;
}
