/* Nearest hits of given rays, and the speed of plain arithmetic: for measuring. */
#define _POSIX_C_SOURCE 200809L
#include <string.h>
#include <time.h>

#include "machine.h"
#include "stream.h"
#include "tree.h"

static double cpu_seconds(void) {
  struct timespec now;
  if (clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now) != 0) return 0;
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static void meet_one_by_one(const ct_kernel *kernel, const void *world, const ct_rays *rays,
                            size_t passes, double *t_world, int64_t *object) {
  for (size_t pass = 0; pass < passes; pass++)
    for (size_t k = 0; k < rays->n; k++) {
      double origin[3], direction[3];
      for (int i = 0; i < 3; i++) {
        origin[i] = rays->origin[i][k];
        direction[i] = rays->direction[i][k];
      }
      kernel->nearest(world, origin, direction, t_world + k, object + k);
    }
}

ct_status ct_intersect(const ct_scene_view *view, const ct_options *options, const ct_rays *rays,
                       size_t passes, double *t_world, int64_t *object, double *seconds) {
  if (!view || !options || !rays || !t_world || !object || passes == 0) return CT_ERR_ARGUMENT;
  if (strcmp(ct_precision_name(options->precision), "f64") != 0 ||
      options->rounding != CT_ROUND_NEAREST)
    return CT_ERR_OPTION;
  const ct_kernel *kernel = ct_precision_kernel(options->precision, options->instructions);
  const ct_stream *stream = ct_stream_for(options);
  ct_machine_state caller = ct_machine_enter();
  ct_frame frame;
  void *world = NULL;
  ct_status status = ct_frame_open(&frame, view, options);
  if (!status) status = ct_frame_sort(&frame, NULL, NULL);
  if (!status) {
    status = stream ? stream->open(&frame, &world) : kernel->open(&frame, &world);
    if (!status) {
      double started = cpu_seconds();
      if (stream)
        stream->intersect(world, rays, passes, t_world, object);
      else
        meet_one_by_one(kernel, world, rays, passes, t_world, object);
      if (seconds) *seconds = cpu_seconds() - started;
      (stream ? stream->close : kernel->close)(world);
    }
    ct_frame_close(&frame);
  }
  ct_machine_leave(caller);
  return status;
}

double ct_peak_flops(const ct_options *options, double seconds) {
  /* About a millisecond a round. */
  enum { ROUNDS = 100000 };
  const ct_stream *stream = options ? ct_stream_for(options) : NULL;
  if (!stream) return 0;
  double best = 0, result, start = cpu_seconds(), before = start, after;
  do {
    double n = stream->multiply_and_add(ROUNDS, &result);
    after = cpu_seconds();
    if (after > before && n / (after - before) > best) best = n / (after - before);
    before = after;
  } while (after - start < seconds);
  return best;
}
