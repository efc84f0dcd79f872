/* What the frame loop knows of a stream: many pixels at a time, traced side by side with the bits
 * of the scalar kernel. Internal.
 */
#ifndef CT_STREAM_H
#define CT_STREAM_H

#include "kernel.h"

/* A rectangle of pixels, and where they go: its first one to `at`, rows `stride` apart. */
typedef struct ct_tile {
  int64_t top, bottom, left, right; /* rows [top, bottom), columns [left, right) */
  size_t at, stride;
  const ct_outputs *out;
} ct_tile;

typedef struct ct_stream {
  ct_status (*open)(const ct_frame *frame, void **world);
  void (*close)(void *world);
  /* The store of one thread; NULL where there is no memory. */
  void *(*enter)(const void *world, const ct_outputs *out);
  void (*leave)(void *store);
  void (*tile)(const void *world, void *store, const ct_tile *tile, ct_pixel *pixel);
  /* Double only (NULL elsewhere): ct_intersect, and the work of ct_peak_flops. */
  void (*intersect)(const void *world, const ct_rays *rays, size_t passes, double *t,
                    int64_t *object);
  double (*multiply_and_add)(size_t rounds, double *result);
} ct_stream;

/* The widest stream that there is for this precision, these options and this processor; NULL where
 * there is none and the kernel traces pixel by pixel. A stream knows the default readings, those
 * that are numbers, and depth, epsilon_twice, exhausted, index, miss and refraction; rounding to
 * nearest alone. */
const ct_stream *ct_stream_for(const ct_options *options);

#endif
