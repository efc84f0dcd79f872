/* Rendering a frame: tiles handed out to threads, results written where the caller wants them.
 *
 * Every pixel is traced alone and written once, so the bits do not depend on which thread took
 * which tile.
 */
#include <stdlib.h>
#include <string.h>

#include "kernel.h"
#include "machine.h"
#include "parallel.h"
#include "stream.h"
#include "tree.h"

enum { TILE_SIDE = 16 };

/* A thread's tiles lie side by side: two threads would fetch each other's part of the image ahead of
 * time. One by one, tiles of phong-bench cost two threads together up to half as much again as one. */
enum { TILES_IN_A_ROW = 32 };

/* AddressSanitizer pads every variable of a frame. */
#if defined(__SANITIZE_ADDRESS__)
enum { STACK_FACTOR = 4 };
#else
enum { STACK_FACTOR = 1 };
#endif

typedef struct job {
  const ct_kernel *kernel;
  const ct_stream *stream; /* NULL: the kernel traces pixel by pixel */
  const void *world;
  const ct_scene_view *view;
  const ct_outputs *out;
  int64_t row_begin, row_end, tiles_across;
  const int64_t *cells; /* NULL: the rows, by tiles */
  int64_t side;
  int rounding; /* of fesetround */
  ct_shared shared;
  atomic_uint_fast64_t n_shadow, n_reflected, n_refracted;
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

size_t ct_kernel_stack(const ct_kernel *kernel, int64_t max_depth) {
  int64_t depth = max_depth < CT_MAX_TREE_DEPTH ? max_depth : CT_MAX_TREE_DEPTH;
  return ((size_t)1 << 20) + (size_t)(depth + 2) * kernel->stack_per_level * STACK_FACTOR;
}

/* What a stream takes beside its kernel, which goes on below its levels. A level's frame holds whole
 * vectors: 11 KiB of AVX-512, and 105 KiB where the compiler does not optimise. */
static size_t stream_stack(int64_t max_depth) {
  enum { LEVELS = 64, BYTES = 131072 };
  return (size_t)((max_depth < LEVELS ? max_depth : LEVELS) + 2) * BYTES * STACK_FACTOR;
}

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

/* What one thread works with. */
typedef struct hand {
  ct_pixel pixel;
  void *store; /* of the stream */
} hand;

static ct_tile cell_at(const job *j, uint64_t index) {
  int64_t across = j->view->h_res / j->side, cell = j->cells[index];
  int64_t top = cell / across * j->side, left = cell % across * j->side;
  size_t side = (size_t)j->side;
  return (ct_tile){top,  top + j->side, left, left + j->side, (size_t)index * side * side,
                   side, j->out};
}

static ct_tile tile_at(const job *j, uint64_t index) {
  if (j->cells) return cell_at(j, index);
  int64_t top = j->row_begin + (int64_t)(index / (uint64_t)j->tiles_across) * TILE_SIDE;
  int64_t left = (int64_t)(index % (uint64_t)j->tiles_across) * TILE_SIDE;
  int64_t bottom = top + TILE_SIDE, right = left + TILE_SIDE;
  size_t stride = (size_t)j->view->h_res;
  return (ct_tile){top,
                   bottom < j->row_end ? bottom : j->row_end,
                   left,
                   right < j->view->h_res ? right : j->view->h_res,
                   (size_t)(top - j->row_begin) * stride + (size_t)left,
                   stride,
                   j->out};
}

static void render_tile(job *j, const ct_tile *tile, hand *thread) {
  ct_pixel *pixel = &thread->pixel;
  if (j->stream) {
    j->stream->tile(j->world, thread->store, tile, pixel);
    return;
  }
  for (int64_t row = tile->top; row < tile->bottom; row++)
    for (int64_t column = tile->left; column < tile->right; column++) {
      pixel->n_rays = 0;
      pixel->tree = 0;
      j->kernel->pixel(j->world, row, column, pixel);
      if (atomic_load_explicit(&j->shared.stop, memory_order_relaxed)) return;
      store(j, tile->at + (size_t)(row - tile->top) * tile->stride + (size_t)(column - tile->left),
            pixel);
    }
}

static void *enter_thread(void *argument) {
  job *j = argument;
  const ct_outputs *out = j->out;
  hand *thread = calloc(1, sizeof *thread);
  if (thread && j->stream) thread->store = j->stream->enter(j->world, out);
  if (!thread || (j->stream && !thread->store)) {
    free(thread);
    atomic_store(&j->shared.stop, CT_ERR_MEMORY);
    return NULL;
  }
  thread->pixel.shared = &j->shared;
  thread->pixel.wants_contributions = out->contributions != NULL;
  thread->pixel.wants_hit = out->object || out->t_world || out->normal;
  fesetround(j->rounding);
  return thread;
}

static void leave_thread(void *argument, void *state) {
  job *j = argument;
  hand *thread = state;
  if (!thread) return;
  ct_pixel_report(&thread->pixel);
  atomic_fetch_add(&j->n_shadow, thread->pixel.n_shadow);
  atomic_fetch_add(&j->n_reflected, thread->pixel.n_reflected);
  atomic_fetch_add(&j->n_refracted, thread->pixel.n_refracted);
  if (j->stream) j->stream->leave(thread->store);
  free(thread);
}

static void render_tiles(void *argument, void *state, uint64_t begin, uint64_t end) {
  for (uint64_t index = begin; state && index < end; index++) {
    ct_tile tile = tile_at(argument, index);
    render_tile(argument, &tile, state);
  }
}

static const int rounding_modes[] = {[CT_ROUND_NEAREST] = FE_TONEAREST,
                                     [CT_ROUND_UP] = FE_UPWARD,
                                     [CT_ROUND_DOWN] = FE_DOWNWARD,
                                     [CT_ROUND_ZERO] = FE_TOWARDZERO};

/* Renders the tiles of a job that says which ones, n_tiles of them. */
static ct_status render_all(job *j, const ct_options *options, uint64_t n_tiles,
                            ct_progress progress, void *user, ct_stats *stats) {
  const ct_kernel *kernel = ct_precision_kernel(options->precision, options->instructions);
  if (options->rounding != CT_ROUND_NEAREST && !kernel->takes_rounding) return CT_ERR_OPTION;
  const ct_stream *stream = ct_stream_for(options);
  ct_machine_state caller = ct_machine_enter();
  ct_frame frame;
  void *world = NULL;
  ct_status status = ct_frame_open(&frame, j->view, options);
  if (!status) status = ct_frame_sort(&frame, progress, user);
  if (!status) {
    status = stream ? stream->open(&frame, &world) : kernel->open(&frame, &world);
    if (!status) {
      j->kernel = kernel;
      j->stream = stream;
      j->world = world;
      j->rounding = rounding_modes[options->rounding];
      j->shared.ray_budget = options->ray_budget;
      ct_work work = {.run = render_tiles, .job = j, .n_items = n_tiles, .chunk = 1,
                      .claim = TILES_IN_A_ROW,
                      .stack_bytes = ct_kernel_stack(kernel, frame.max_depth) +
                                     (stream ? stream_stack(frame.max_depth) : 0),
                      .enter = enter_thread, .leave = leave_thread, .stop = &j->shared.stop};
      unsigned n_threads = 0;
      status = ct_parallel(&work, options->n_threads, progress, user, &n_threads);
      if (stats && !status)
        *stats = (ct_stats){0, j->n_shadow, j->n_reflected, j->n_refracted, n_threads};
      (stream ? stream->close : kernel->close)(world);
    }
    ct_frame_close(&frame);
  }
  ct_machine_leave(caller);
  return status;
}

ct_status ct_render(const ct_scene_view *view, const ct_options *options,
                    const ct_outputs *outputs, ct_progress progress, void *user,
                    ct_stats *stats) {
  if (!view || !options || !outputs) return CT_ERR_ARGUMENT;
  int64_t begin = options->row_begin, end = options->row_end ? options->row_end : view->v_res;
  if (begin < 0 || begin >= end || end > view->v_res) return CT_ERR_ARGUMENT;
  int64_t across = (view->h_res + TILE_SIDE - 1) / TILE_SIDE;
  int64_t down = (end - begin + TILE_SIDE - 1) / TILE_SIDE;
  job j = {.view = view, .out = outputs, .row_begin = begin, .row_end = end,
           .tiles_across = across};
  ct_status status =
      render_all(&j, options, (uint64_t)across * (uint64_t)down, progress, user, stats);
  if (stats && !status) stats->n_primary = (uint64_t)(end - begin) * (uint64_t)view->h_res;
  return status;
}

ct_status ct_render_cells(const ct_scene_view *view, const ct_options *options,
                          const int64_t *cells, uint64_t n_cells, int64_t side,
                          const ct_outputs *outputs, ct_progress progress, void *user,
                          ct_stats *stats) {
  if (!view || !options || !outputs || (!cells && n_cells > 0)) return CT_ERR_ARGUMENT;
  if (side < 1 || side > CT_LARGEST_CELL || view->v_res % side || view->h_res % side)
    return CT_ERR_ARGUMENT;
  int64_t n_all = (view->v_res / side) * (view->h_res / side);
  for (uint64_t i = 0; i < n_cells; i++)
    if (cells[i] < 0 || cells[i] >= n_all) return CT_ERR_ARGUMENT;
  if (stats) *stats = (ct_stats){0};
  if (n_cells == 0) return CT_OK;
  job j = {.view = view, .out = outputs, .cells = cells, .side = side};
  ct_status status = render_all(&j, options, n_cells, progress, user, stats);
  if (stats && !status) stats->n_primary = n_cells * (uint64_t)side * (uint64_t)side;
  return status;
}
