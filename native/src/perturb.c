/* Conditioning: pixels rendered many times over with random errors of the size of a rounding.
 *
 * What the samples of a pixel have in common is what rounding cannot change, and their spread is
 * what it can. Every sample has a stream of random numbers of its own (perturb.inc.h).
 */
#include <stdlib.h>
#include <string.h>

#include "kernel.h"
#include "machine.h"
#include "parallel.h"
#include "tree.h"

extern const ct_kernel ct_kernel_f64_perturbed;

typedef struct job {
  const void *world;
  const ct_scene_view *view;
  const ct_perturb_request *request;
  const ct_samples *out;
  ct_shared shared;
} job;

static void sample_pixels(void *argument, void *state, uint64_t begin, uint64_t end) {
  job *j = argument;
  ct_pixel *pixel = state;
  const ct_perturb_request *q = j->request;
  for (uint64_t at = begin; pixel && at < end; at++) {
    int64_t index = q->pixels ? q->pixels[at] : (int64_t)at;
    uint64_t pixel_stream = ct_tree_mix(ct_tree_mix(0, q->seed), (uint64_t)index);
    for (uint64_t k = 0; k < q->n_samples; k++) {
      pixel->tree = 0;
      pixel->n_rays = 0;
      pixel->n_draws = 0;
      pixel->by_component = (int)(k & 1);
      pixel->stream = ct_tree_mix(pixel_stream, k);
      ct_kernel_f64_perturbed.pixel(j->world, index / j->view->h_res, index % j->view->h_res,
                                    pixel);
      if (atomic_load_explicit(&j->shared.stop, memory_order_relaxed)) return;
      size_t to = (size_t)(at * q->n_samples + k);
      if (j->out->colors) memcpy(j->out->colors + 3 * to, pixel->color, sizeof pixel->color);
      if (j->out->trees) j->out->trees[to] = pixel->tree;
    }
  }
}

static void *enter_thread(void *argument) {
  job *j = argument;
  ct_pixel *pixel = calloc(1, sizeof *pixel);
  if (!pixel) {
    atomic_store(&j->shared.stop, CT_ERR_MEMORY);
    return NULL;
  }
  pixel->shared = &j->shared;
  pixel->error = j->request->error;
  return pixel;
}

static void leave_thread(void *argument, void *state) {
  (void)argument;
  if (state) ct_pixel_report(state);
  free(state);
}

static int is_possible(const ct_scene_view *view, const ct_perturb_request *q) {
  int64_t n_pixels = view->v_res * view->h_res;
  if (!(q->error >= 0 && q->error < 1)) return 0;
  for (uint64_t i = 0; q->pixels && i < q->n_pixels; i++)
    if (q->pixels[i] < 0 || q->pixels[i] >= n_pixels) return 0;
  return 1;
}

ct_status ct_perturb(const ct_scene_view *view, const ct_options *options,
                     const ct_perturb_request *request, const ct_samples *out,
                     ct_progress progress, void *user) {
  if (!view || !options || !request || !out || !is_possible(view, request))
    return CT_ERR_ARGUMENT;
  if (strcmp(ct_precision_name(options->precision), ct_kernel_f64_perturbed.name) != 0 ||
      options->rounding != CT_ROUND_NEAREST)
    return CT_ERR_OPTION;
  ct_machine_state caller = ct_machine_enter();
  ct_frame frame;
  void *world = NULL;
  ct_status status = ct_frame_open(&frame, view, options);
  if (!status) status = ct_frame_sort(&frame, progress, user);
  if (!status) {
    status = ct_kernel_f64_perturbed.open(&frame, &world);
    if (!status) {
      job j = {.world = world, .view = view, .request = request, .out = out,
               .shared = {.ray_budget = options->ray_budget}};
      uint64_t n = request->pixels ? request->n_pixels : (uint64_t)(view->v_res * view->h_res);
      ct_work work = {.run = sample_pixels, .job = &j, .n_items = n, .chunk = 1,
                      .stack_bytes = ct_kernel_stack(&ct_kernel_f64_perturbed, frame.max_depth),
                      .enter = enter_thread, .leave = leave_thread, .stop = &j.shared.stop};
      status = ct_parallel(&work, options->n_threads, progress, user, NULL);
      ct_kernel_f64_perturbed.close(world);
    }
    ct_frame_close(&frame);
  }
  ct_machine_leave(caller);
  return status;
}
