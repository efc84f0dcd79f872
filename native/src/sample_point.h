/* Where on the view plane the ray of a pixel passes, in pixels from the plane's middle: right of it
 * and below it. The same for every precision, so that all of them trace the same ray. Internal.
 */
#ifndef CT_SAMPLE_POINT_H
#define CT_SAMPLE_POINT_H

#include "kernel.h"

/* 32 bits as a number that is uniform over (-0.5, 0.5). */
static inline double ct_off_centre(uint64_t bits) {
  return ((double)(bits & 0xffffffff) + 0.5) * 0x1p-32 - 0.5;
}

static inline void ct_sample_point(const ct_frame *frame, int64_t row, int64_t column,
                                   double *right, double *below) {
  const ct_scene_view *v = &frame->view;
  /* Halves of integers: exact in every type. */
  *right = (double)column - (double)v->h_res / 2 + 0.5;
  *below = (double)row - (double)v->v_res / 2 + 0.5;
  uint64_t seed = frame->options->jitter;
  if (!seed) return;
  uint64_t bits = ct_tree_mix(ct_tree_mix(seed, (uint64_t)row), (uint64_t)column);
  *right += ct_off_centre(bits);
  *below += ct_off_centre(bits >> 32);
}

#endif
