/* Which object's interior a ray is in, for the reading nesting=tracked. */
#include "kernel.h"

/* Walks back over the crossings and skips an entry for every later exit from the same object. The
 * list is as long as the path, so the square of its length is still small. */
double ct_medium_index(const ct_scene_view *view, const ct_medium *medium) {
  for (const ct_medium *m = medium; m; m = m->before) {
    if (m->change < 0) continue;
    int balance = 1;
    for (const ct_medium *later = medium; later != m; later = later->before)
      if (later->object == m->object) balance += later->change;
    if (balance > 0) return view->material[m->object * CT_MATERIAL_COLUMNS + CT_N];
  }
  return 1;
}

static int contains_eye(const ct_scene_view *view, size_t i) {
  const double *g = view->geometry + i * CT_GEOMETRY_COLUMNS;
  double sum = 0;
  if (view->kind[i] == CT_PLANE) {
    for (int k = 0; k < 3; k++) sum += (view->eye[k] - g[k]) * g[3 + k];
    return sum < 0;
  }
  for (int k = 0; k < 3; k++) sum += (view->eye[k] - g[k]) * (view->eye[k] - g[k]);
  return sum < g[3] * g[3];
}

/* Larger spheres lie further out; a half-space lies outside every sphere. */
static double extent(const ct_scene_view *view, size_t i) {
  return view->kind[i] == CT_PLANE ? (double)CT_MAX_TREE_DEPTH * 1e100
                                   : view->geometry[i * CT_GEOMETRY_COLUMNS + 3];
}

const ct_medium *ct_media_around_eye(const ct_scene_view *view,
                                     ct_medium media[CT_MEDIA_AROUND_EYE]) {
  size_t n = 0;
  for (size_t i = 0; i < view->n_objects; i++) {
    if (!(view->material[i * CT_MATERIAL_COLUMNS + CT_KT] > 0) || !contains_eye(view, i)) continue;
    if (n == CT_MEDIA_AROUND_EYE) break;
    size_t at = n++;
    for (; at > 0 && extent(view, media[at - 1].object) < extent(view, i); at--)
      media[at].object = media[at - 1].object;
    media[at].object = i;
  }
  for (size_t k = 0; k < n; k++) {
    media[k].before = k ? &media[k - 1] : NULL;
    media[k].change = 1;
  }
  return n ? &media[n - 1] : NULL;
}
