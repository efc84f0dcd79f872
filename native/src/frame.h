/* What is decided once per frame, in the widest type: camera basis, unit normals, and which
 * surfaces the eye lies on. Every precision and the set-valued kernel start from it. Internal. */
#ifndef CT_FRAME_H
#define CT_FRAME_H

#include "bvh.h"
#include "medium.h"
#include "options.h"
#include "wide.h"

typedef struct ct_frame {
  ct_scene_view view;
  const ct_options *options;
  ct_wide u[3], v[3], w[3]; /* specification 2.3 */
  double *material; /* view.material with other indices, where a reading asks for them; or NULL */
  size_t n_planes;
  uint32_t *plane_slot;   /* n_objects; meaningful where kind is CT_PLANE */
  ct_wide *plane_normal;  /* n_planes x 3, unit */
  uint8_t *eye_on;        /* n_objects: 1 where the eye lies on the surface */
  int64_t max_depth;
  /* Lights that lie exactly on a surface: there is no telling by rounding whether it stands before
   * them, and the design says that it does not. Few or none, in rising order of light. */
  size_t n_lights_on;
  struct {
    size_t light, object;
  } *lights_on;
  const ct_bvh *bvh; /* NULL: every object is asked */
  ct_bvh *own_bvh;   /* the same where it is the frame's own */
  /* What the eye is in, but for nesting=relative; the list's links lie in the frame. */
  ct_medium around[CT_MEDIA_AROUND_EYE];
  const ct_medium *eye_medium;
} ct_frame;

ct_status ct_frame_open(ct_frame *frame, const ct_scene_view *view, const ct_options *options);
void ct_frame_close(ct_frame *frame);

static inline int ct_light_is_on(const ct_frame *frame, size_t light, size_t object) {
  for (size_t k = 0; k < frame->n_lights_on; k++)
    if (frame->lights_on[k].light == light && frame->lights_on[k].object == object) return 1;
  return 0;
}

#endif
