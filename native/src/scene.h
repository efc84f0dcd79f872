/* A scene that owns its arrays. Internal. */
#ifndef CT_SCENE_H
#define CT_SCENE_H

#include "crosstrace.h"

struct ct_scene {
  ct_scene_view view; /* its pointers are the arrays below */
  uint8_t *kind;
  double *color, *material, *geometry, *lights;
};

/* Makes room for objects and lights; the arrays are not initialised. */
ct_status ct_scene_reserve_objects(ct_scene *scene, size_t n_objects);
ct_status ct_scene_reserve_lights(ct_scene *scene, size_t n_lights);

#endif
