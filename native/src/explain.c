/* The ray tree of one pixel, recorded by a kernel of its own (kernel_explain.c). */
#include <string.h>

#include "machine.h"
#include "parallel.h"
#include "recorder.h"
#include "tree.h"

typedef struct job {
  const void *world;
  int64_t row, column;
  ct_recorder recorder;
  ct_shared shared;
} job;

static void record_pixel(void *argument, void *state, uint64_t begin, uint64_t end) {
  job *j = argument;
  (void)state, (void)begin, (void)end;
  ct_kernel_explain.pixel(j->world, j->row, j->column, &j->recorder.pixel);
}

/* In a thread of its own, for the stack that a deep tree needs. */
static ct_status run(job *j, const ct_frame *frame, ct_progress progress, void *user) {
  void *world = NULL;
  ct_status status = ct_kernel_explain.open(frame, &world);
  if (status) return status;
  j->world = world;
  ct_work work = {.run = record_pixel, .job = j, .n_items = 1, .chunk = 1,
                  .stack_bytes = ct_kernel_stack(&ct_kernel_explain, frame->max_depth),
                  .stop = &j->shared.stop};
  status = ct_parallel(&work, 1, progress, user, NULL);
  ct_kernel_explain.close(world);
  return status;
}

ct_status ct_explain(const ct_scene_view *view, const ct_options *options, int64_t row,
                     int64_t column, ct_ray_record *records, size_t capacity, ct_pixel_tree *tree,
                     ct_progress progress, void *user) {
  if (!view || !options || !tree || (capacity && !records)) return CT_ERR_ARGUMENT;
  if (row < 0 || row >= view->v_res || column < 0 || column >= view->h_res)
    return CT_ERR_ARGUMENT;
  if (strcmp(ct_precision_name(options->precision), ct_kernel_explain.name) != 0 ||
      options->rounding != CT_ROUND_NEAREST)
    return CT_ERR_OPTION;
  ct_machine_state caller = ct_machine_enter();
  ct_frame frame;
  ct_status status = ct_frame_open(&frame, view, options);
  if (!status) status = ct_frame_sort(&frame, progress, user);
  if (!status) {
    job j = {.row = row, .column = column,
             .recorder = {.records = records, .capacity = capacity,
                          .open = {-1, -1, 1}, .next_factor = 1},
             .shared = {.ray_budget = options->ray_budget}};
    j.recorder.pixel.shared = &j.shared;
    status = run(&j, &frame, progress, user);
    *tree = (ct_pixel_tree){.n_rays = (uint64_t)j.recorder.n_rays, .tree = j.recorder.pixel.tree};
    memcpy(tree->color, j.recorder.pixel.color, sizeof tree->color);
    ct_frame_close(&frame);
  }
  ct_machine_leave(caller);
  return status;
}
