/* Certified pixels many at a time: the set-valued kernel in double over lanes of rays.
 *
 * A third text of the same meaning, for speed: intervals in vectors, in recursive streams. It
 * closes the pixels whose every decision is certain, under the readings that renderers' habits
 * need; every other pixel it leaves open, and says no more of it. The scalar kernel (set.h) then
 * does that pixel from the start. A pixel's bits depend on nothing but the pixel: neither on its
 * neighbours nor on the instruction set.
 */
#ifndef CT_SET_STREAM_H
#define CT_SET_STREAM_H

#include "set.h"

enum { CT_SET_STREAM = 64 }; /* pixels at a time, at most */

typedef struct ct_set_batch {
  double lo[3][CT_SET_STREAM], hi[3][CT_SET_STREAM];
  unsigned char open[CT_SET_STREAM]; /* 1: nothing is known of this pixel */
} ct_set_batch;

/* Every function of it is to be called with the processor rounding upward. */
typedef struct ct_set_stream {
  ct_status (*open)(const ct_frame *frame, void **world);
  void (*close)(void *world);
  /* The pixels row * h_res + column, n <= CT_SET_STREAM of them. */
  void (*batch)(const void *world, const int64_t *pixels, int n, const ct_set_limits *limits,
                ct_set_batch *out);
} ct_set_stream;

/* The stream for this processor; NULL where only the scalar kernel knows the frame's readings or
 * can hold its numbers. */
const ct_set_stream *ct_set_stream_for(const ct_frame *frame);

#endif
