/* Which objects' interiors a ray is in, for the readings nesting=tracked and interiors. Internal. */
#ifndef CT_MEDIUM_H
#define CT_MEDIUM_H

#include "crosstrace.h"

#define CT_MEDIA_AROUND_EYE 32

/* One crossing of a surface by a ray, newest first; nesting=tracked follows the list. */
typedef struct ct_medium {
  const struct ct_medium *before;
  size_t object;
  int change; /* +1 entered, -1 left */
} ct_medium;

/* The index of the innermost object that the ray is in; 1 in none. */
double ct_medium_index(const ct_scene_view *view, const ct_medium *medium);

/* The crossing of an object's surface: out of it from its inside, or, under nesting=interiors, where
 * the list says that the ray is in it. */
ct_medium ct_medium_crossed(int nesting, const ct_medium *medium, size_t object, int inside);

/* Whether the ray goes straight on, as no bounce (nesting=interiors): the index stays the same. */
int ct_medium_passes(const ct_scene_view *view, int nesting, const ct_medium *crossing);

/* The transparent objects around the eye, outermost first, as a list of crossings. */
const ct_medium *ct_media_around_eye(const ct_scene_view *view,
                                     ct_medium media[CT_MEDIA_AROUND_EYE]);

#endif
