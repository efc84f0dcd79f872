/* Camera basis (specification 2.3), unit normals and the eye's surfaces, in the widest type.
 *
 * The inputs are doubles, so differences and products of two of them are exact or nearly so in a
 * type of twice the width, and each result here is within a few units of that type's last place.
 */
#include "frame.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Square root to the full width: the double root, then two Newton steps, each of which doubles the
 * correct digits. x > 0 and its root within double's range. */
static ct_wide wide_sqrt(ct_wide x) {
  /* Scale by an even power of two, so that the starting value neither over- nor underflows. */
  int shift = 0;
  while (x > (ct_wide)0x1p1000) x *= (ct_wide)0x1p-500, x *= (ct_wide)0x1p-500, shift += 500;
  while (x < (ct_wide)0x1p-1000) x *= (ct_wide)0x1p500, x *= (ct_wide)0x1p500, shift -= 500;
  ct_wide y = (ct_wide)sqrt((double)x);
  for (int i = 0; i < 2; i++) y = (y + x / y) / 2;
  ct_wide scale = (ct_wide)(shift > 0 ? 0x1p500 : 0x1p-500);
  for (int s = abs(shift); s > 0; s -= 500) y *= scale;
  return y;
}

static ct_wide wide_abs(ct_wide x) { return x < 0 ? -x : x; }

static ct_wide wide_max(ct_wide a, ct_wide b) { return a > b ? a : b; }

static ct_wide dot3(const ct_wide a[3], const ct_wide b[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void normalise(ct_wide a[3]) {
  ct_wide length = wide_sqrt(dot3(a, a));
  for (int i = 0; i < 3; i++) a[i] /= length;
}

static void cross(const ct_wide a[3], const ct_wide b[3], ct_wide out[3]) {
  for (int i = 0; i < 3; i++) {
    int j = (i + 1) % 3, k = (i + 2) % 3;
    out[i] = a[j] * b[k] - a[k] * b[j];
  }
}

static void set_camera(ct_frame *frame) {
  ct_wide up[3];
  for (int i = 0; i < 3; i++) {
    frame->w[i] = (ct_wide)frame->view.eye[i] - (ct_wide)frame->view.target[i];
    up[i] = frame->view.up[i];
  }
  normalise(frame->w);
  normalise(up);
  cross(up, frame->w, frame->u);
  normalise(frame->u);
  cross(frame->w, frame->u, frame->v);
}

/* The design's rule: the eye lies on a surface when its distance from it is within 4 ulp of the
 * magnitudes involved, here the coordinates that the distance is the difference of. The course's
 * scenes put the eye on a plane by a coordinate that equals another; the rule asks no more. */
static int eye_on_plane(const ct_frame *frame, const double *geometry, const ct_wide normal[3]) {
  ct_wide distance = 0, scale = 0;
  for (int i = 0; i < 3; i++) {
    ct_wide e = frame->view.eye[i], p = geometry[i];
    distance += normal[i] * (e - p);
    scale += wide_abs(normal[i]) * (wide_abs(e) + wide_abs(p));
  }
  return wide_abs(distance) <= 4 * (ct_wide)DBL_EPSILON * scale;
}

/* Whether the eye is off the sphere by so much that double is enough to tell: with scale as below,
 * the distance is wrong by a few units of 2^-53 of it, unless squares vanish. */
static int surely_off_sphere(const ct_frame *frame, const double *geometry) {
  double square = 0, scale = geometry[3];
  for (int i = 0; i < 3; i++) {
    double e = frame->view.eye[i], c = geometry[i];
    square += (e - c) * (e - c);
    scale = fmax(scale, fmax(fabs(e), fabs(c)));
  }
  return scale > 1e-100 && fabs(sqrt(square) - geometry[3]) > 1e-12 * scale;
}

static int eye_on_sphere(const ct_frame *frame, const double *geometry) {
  if (surely_off_sphere(frame, geometry)) return 0;
  ct_wide f[3], r = geometry[3], scale = r;
  for (int i = 0; i < 3; i++) {
    ct_wide e = frame->view.eye[i], c = geometry[i];
    f[i] = e - c;
    scale = wide_max(scale, wide_max(wide_abs(e), wide_abs(c)));
  }
  ct_wide square = dot3(f, f);
  if (square == 0) return 0;
  return wide_abs(wide_sqrt(square) - r) <= 4 * (ct_wide)DBL_EPSILON * scale;
}

/* Exactly on it, as far as the widest type can tell: the equation's two sides are equal. */
static int light_on_surface(const ct_scene_view *view, size_t i, const double *light) {
  const double *g = view->geometry + i * CT_GEOMETRY_COLUMNS;
  int is_plane = view->kind[i] == CT_PLANE;
  /* In double first: far most pairs are far from equal. */
  double near = is_plane ? 0 : -g[3] * g[3], scale = fabs(near);
  for (int k = 0; k < 3; k++) {
    double term = (light[k] - g[k]) * (is_plane ? g[3 + k] : light[k] - g[k]);
    near += term;
    scale += fabs(term);
  }
  if (fabs(near) > 1e-12 * scale) return 0;
  ct_wide sum = is_plane ? 0 : -(ct_wide)g[3] * g[3];
  for (int k = 0; k < 3; k++) {
    ct_wide way = (ct_wide)light[k] - g[k];
    sum += way * (is_plane ? (ct_wide)g[3 + k] : way);
  }
  return sum == 0;
}

static ct_status find_lights_on(ct_frame *frame) {
  const ct_scene_view *view = &frame->view;
  size_t room = 0;
  for (size_t j = 0; j < view->n_lights; j++)
    for (size_t i = 0; i < view->n_objects; i++) {
      if (!light_on_surface(view, i, view->lights + j * CT_LIGHT_COLUMNS + 3)) continue;
      if (frame->n_lights_on == room) {
        room = room ? 2 * room : 8;
        void *more = realloc(frame->lights_on, room * sizeof *frame->lights_on);
        if (!more) return CT_ERR_MEMORY;
        frame->lights_on = more;
      }
      frame->lights_on[frame->n_lights_on].light = j;
      frame->lights_on[frame->n_lights_on++].object = i;
    }
  return CT_OK;
}

/* The nearest float other than 0 and infinity, and for 1 the next above it: POV-Ray bends nothing
 * where the index is 1, and its users write this. */
static double float_index(double n) {
  float rounded = n > (double)FLT_MAX ? FLT_MAX : n < (double)FLT_MIN ? FLT_MIN : (float)n;
  return (double)(rounded == 1.0f ? 1.0f + FLT_EPSILON : rounded);
}

static ct_status set_indices(ct_frame *frame) {
  size_t n = frame->view.n_objects;
  if (frame->options->choice[CT_INDEX] != CT_INDEX_FLOAT32 || n == 0) return CT_OK;
  frame->material = malloc(n * CT_MATERIAL_COLUMNS * sizeof *frame->material);
  if (!frame->material) return CT_ERR_MEMORY;
  memcpy(frame->material, frame->view.material, n * CT_MATERIAL_COLUMNS * sizeof(double));
  for (size_t i = 0; i < n; i++) {
    double *index = frame->material + i * CT_MATERIAL_COLUMNS + CT_N;
    if (*index > 0) *index = float_index(*index); /* 0: an object that bends nothing */
  }
  frame->view.material = frame->material;
  return CT_OK;
}

static size_t count_planes(const ct_scene_view *view) {
  size_t n = 0;
  for (size_t i = 0; i < view->n_objects; i++) n += view->kind[i] == CT_PLANE;
  return n;
}

ct_status ct_frame_open(ct_frame *frame, const ct_scene_view *view, const ct_options *options) {
  memset(frame, 0, sizeof *frame);
  frame->view = *view;
  frame->options = options;
  frame->max_depth = ct_effective_depth(view, options);
  frame->n_planes = count_planes(view);
  size_t n = view->n_objects ? view->n_objects : 1;
  frame->eye_on = calloc(n, 1);
  frame->plane_normal = malloc((frame->n_planes + 1) * 3 * sizeof *frame->plane_normal);
  frame->plane_slot = frame->n_planes ? malloc(n * sizeof *frame->plane_slot) : NULL;
  if (!frame->eye_on || !frame->plane_normal || (frame->n_planes && !frame->plane_slot)) {
    ct_frame_close(frame);
    return CT_ERR_MEMORY;
  }
  set_camera(frame);
  uint32_t slot = 0;
  for (size_t i = 0; i < view->n_objects; i++) {
    const double *geometry = view->geometry + i * CT_GEOMETRY_COLUMNS;
    if (view->kind[i] == CT_SPHERE) {
      frame->eye_on[i] = (uint8_t)eye_on_sphere(frame, geometry);
      continue;
    }
    ct_wide *normal = frame->plane_normal + (size_t)slot * 3;
    for (int k = 0; k < 3; k++) normal[k] = geometry[3 + k];
    normalise(normal);
    frame->eye_on[i] = (uint8_t)eye_on_plane(frame, geometry, normal);
    frame->plane_slot[i] = slot++;
  }
  ct_status status = find_lights_on(frame);
  if (!status) status = set_indices(frame);
  if (options->choice[CT_NESTING] != CT_NESTING_RELATIVE)
    frame->eye_medium = ct_media_around_eye(&frame->view, frame->around);
  if (status) ct_frame_close(frame);
  return status;
}

void ct_frame_close(ct_frame *frame) {
  ct_bvh_close(frame->own_bvh);
  free(frame->lights_on);
  free(frame->material);
  free(frame->eye_on);
  free(frame->plane_normal);
  free(frame->plane_slot);
}
