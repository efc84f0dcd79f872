/* Which object's interior a ray is in, for the readings nesting=tracked and nesting=interiors. */
#include <math.h>

#include "kernel.h"
#include "options.h"

/* The entry into the object that was entered last and is not left; NULL: none.
 *
 * Walks back over the crossings and skips an entry for every later exit from the same object. The
 * list is as long as the path, so the square of its length is still small. */
static const ct_medium *innermost(const ct_medium *medium) {
  for (const ct_medium *m = medium; m; m = m->before) {
    if (m->change < 0) continue;
    int balance = 1;
    for (const ct_medium *later = medium; later != m; later = later->before)
      if (later->object == m->object) balance += later->change;
    if (balance > 0) return m;
  }
  return NULL;
}

double ct_medium_index(const ct_scene_view *view, const ct_medium *medium) {
  const ct_medium *m = innermost(medium);
  return m ? view->material[m->object * CT_MATERIAL_COLUMNS + CT_N] : 1;
}

static int is_in(const ct_medium *medium, size_t object) {
  int balance = 0;
  for (const ct_medium *m = medium; m; m = m->before)
    if (m->object == object) balance += m->change;
  return balance > 0;
}

ct_medium ct_medium_crossed(int nesting, const ct_medium *medium, size_t object, int inside) {
  int leaves = nesting == CT_NESTING_INTERIORS ? is_in(medium, object) : inside;
  return (ct_medium){medium, object, leaves ? -1 : 1};
}

/* POV-Ray's EPSILON, within which two indices are one (its frame.h). */
#define SAME_INDEX 1e-10

int ct_medium_passes(const ct_scene_view *view, int nesting, const ct_medium *crossing) {
  if (nesting != CT_NESTING_INTERIORS) return 0;
  double before = ct_medium_index(view, crossing->before), after = ct_medium_index(view, crossing);
  return fabs(before / after - 1) < SAME_INDEX;
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
