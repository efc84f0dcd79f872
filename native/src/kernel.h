/* What the frame loop knows of a kernel: one pixel at a time, whatever the scalar type. Internal. */
#ifndef CT_KERNEL_H
#define CT_KERNEL_H

#include <stdatomic.h>

#include "frame.h"

/* Deep enough for any mirror; a recursion deeper than this ends in CT_ERR_DEPTH. */
#define CT_MAX_TREE_DEPTH 100000

/* The state that all threads of a frame share. */
typedef struct ct_shared {
  atomic_int stop; /* a ct_status: why everybody is to stop */
  atomic_uint_fast64_t rays_used;
  uint64_t ray_budget;
} ct_shared;

/* One pixel being traced by one thread, and what comes out. */
typedef struct ct_pixel {
  ct_shared *shared;
  uint32_t n_rays; /* of the pixel, of every kind */
  uint32_t n_unreported;
  uint64_t n_shadow, n_reflected, n_refracted; /* running totals of the thread */
  int wants_contributions, wants_hit;
  double color[3], color_low[3], contributions[CT_CONTRIBUTIONS * 3];
  int32_t object;
  double t_world, normal[3];
  uint64_t tree;
  /* Of the perturbed kernel: how far to move things, relative to their scale, and a stream of random
   * numbers that is the pixel's and the sample's own. */
  double error;
  int by_component;
  uint64_t stream, n_draws;
} ct_pixel;

typedef struct ct_kernel {
  const char *name; /* of the precision, as an option */
  size_t stack_per_level; /* bytes for one level of the recursion, measured, with room to spare */
  int takes_rounding;     /* may run in any rounding mode of the processor */
  ct_status (*open)(const ct_frame *frame, void **world);
  void (*close)(void *world);
  void (*pixel)(const void *world, int64_t row, int64_t column, ct_pixel *pixel);
} ct_kernel;

/* The kernel of a precision: index from 0, narrowest first; NULL past the last that exists here.
 * `cap` is the most of the processor's instruction sets that it may use. */
const ct_kernel *ct_precision_kernel(size_t index, ct_instructions cap);

/* The finaliser of splitmix64 (Steele, Lea and Flood 2014) over a running hash: decisions in
 * depth-first order give one number for the tree. */
static inline uint64_t ct_tree_mix(uint64_t hash, uint64_t value) {
  uint64_t z = hash + UINT64_C(0x9e3779b97f4a7c15) * (value + 1);
  z = (z ^ (z >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
  z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
  return z ^ (z >> 31);
}

void ct_pixel_report(ct_pixel *pixel);

/* Bytes of stack that a thread needs for trees of that depth. */
size_t ct_kernel_stack(const ct_kernel *kernel, int64_t max_depth);

/* Counts a ray, and says whether this thread is to give up: asked to, out of budget, too deep. */
static inline int ct_pixel_must_stop(ct_pixel *pixel, int64_t depth) {
  pixel->n_rays++;
  if (++pixel->n_unreported >= 4096) ct_pixel_report(pixel);
  if (depth > CT_MAX_TREE_DEPTH) atomic_store(&pixel->shared->stop, CT_ERR_DEPTH);
  return atomic_load_explicit(&pixel->shared->stop, memory_order_relaxed) != CT_OK;
}

#endif
