/* What is kept while the rays of one pixel are recorded. Internal. */
#ifndef CT_RECORDER_H
#define CT_RECORDER_H

#include "kernel.h"

/* The ray at whose hit the kernel is; its record may lie beyond the capacity. */
typedef struct ct_open_ray {
  int64_t index, object;
  double weight;
} ct_open_ray;

typedef struct ct_recorder {
  ct_pixel pixel; /* first: the kernel is given this part and hands it to its hooks */
  ct_ray_record *records;
  size_t capacity;
  int64_t n_rays;
  ct_open_ray open;
  ct_ray_kind next_kind; /* of the ray to come, and what its weight is multiplied by */
  double next_factor;
  double diffuse[3], specular[3]; /* of the light to which a shadow ray is about to be sent */
  ct_ray_record spare;            /* takes what is beyond the capacity */
} ct_recorder;

static inline ct_ray_record *ct_recorder_at(ct_recorder *recorder, int64_t index) {
  return (size_t)index < recorder->capacity ? &recorder->records[index] : &recorder->spare;
}

extern const ct_kernel ct_kernel_explain;

#endif
