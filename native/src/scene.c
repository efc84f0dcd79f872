/* Scenes as plain data: storage for the parser, and the check of a view that was built by hand. */
#include "scene.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "text.h"

void ct_default_material(int delivery, double material[CT_MATERIAL_COLUMNS]) {
  memset(material, 0, CT_MATERIAL_COLUMNS * sizeof *material);
  material[CT_KA] = delivery == 1 ? 1 : 0; /* an unlit colour is an ambient term in white light */
  material[CT_ETA] = 1;
  material[CT_N] = 1;
}

static void *new_array(size_t n, size_t item_bytes) {
  if (n > SIZE_MAX / item_bytes) return NULL;
  return malloc(n ? n * item_bytes : 1);
}

ct_status ct_scene_reserve_objects(ct_scene *scene, size_t n_objects) {
  scene->view.kind = scene->kind = new_array(n_objects, sizeof *scene->kind);
  scene->view.color = scene->color = new_array(n_objects, 3 * sizeof(double));
  scene->view.material = scene->material =
      new_array(n_objects, CT_MATERIAL_COLUMNS * sizeof(double));
  scene->view.geometry = scene->geometry =
      new_array(n_objects, CT_GEOMETRY_COLUMNS * sizeof(double));
  return scene->kind && scene->color && scene->material && scene->geometry ? CT_OK
                                                                           : CT_ERR_MEMORY;
}

ct_status ct_scene_reserve_lights(ct_scene *scene, size_t n_lights) {
  scene->view.lights = scene->lights = new_array(n_lights, CT_LIGHT_COLUMNS * sizeof(double));
  return scene->lights ? CT_OK : CT_ERR_MEMORY;
}

void ct_scene_free(ct_scene *scene) {
  if (!scene) return;
  free(scene->kind);
  free(scene->color);
  free(scene->material);
  free(scene->geometry);
  free(scene->lights);
  free(scene);
}

ct_scene_view ct_scene_data(const ct_scene *scene) { return scene->view; }

/* ---- The check of plain data ---- */

static ct_status check(ct_rule rule, const double *values, size_t n, const char *field,
                       ct_fault *fault) {
  for (size_t i = 0; i < n; i++) {
    const char *expected = ct_rule_breach(rule, values[i]);
    if (!expected) continue;
    char where[96];
    snprintf(where, sizeof where, n > 1 ? "%s[%zu]" : "%s", field, i);
    ct_fault_number(fault, where, expected, values[i]);
    return CT_ERR_SCENE;
  }
  return CT_OK;
}

static ct_status refuse_triple(ct_fault *fault, const char *where, const char *expected,
                               const double v[3]) {
  char found[96];
  snprintf(found, sizeof found, "%.6g %.6g %.6g", v[0], v[1], v[2]);
  ct_fault_set(fault, where, expected, found);
  return CT_ERR_SCENE;
}

static ct_status check_camera(const ct_scene_view *v, ct_fault *fault) {
  double sides[2] = {(double)v->v_res, (double)v->h_res}, depth = (double)v->max_depth;
  ct_status status;
  if (v->delivery < 1 || v->delivery > 3) {
    ct_fault_number(fault, "delivery", "1, 2 or 3", v->delivery);
    return CT_ERR_SCENE;
  }
  if ((status = check(CT_RULE_RESOLUTION, sides, 1, "v_res", fault)) ||
      (status = check(CT_RULE_RESOLUTION, sides + 1, 1, "h_res", fault)) ||
      (status = check(CT_RULE_POSITIVE, &v->pixel_size, 1, "pixel_size", fault)) ||
      (status = check(CT_RULE_POSITIVE, &v->screen_distance, 1, "screen_distance", fault)) ||
      (status = check(CT_RULE_FINITE, v->eye, 3, "eye", fault)) ||
      (status = check(CT_RULE_FINITE, v->target, 3, "target", fault)) ||
      (status = check(CT_RULE_FINITE, v->up, 3, "up", fault)) ||
      (status = check(CT_RULE_COLOR, v->background, 3, "background", fault)) ||
      (status = check(CT_RULE_COLOR, v->ambient, 3, "ambient", fault)) ||
      (status = check(CT_RULE_COUNT, &depth, 1, "max_depth", fault)))
    return status;
  if (v->delivery < 3 && v->max_depth != 0) {
    ct_fault_number(fault, "max_depth", "0, as deliveries 1 and 2 have no secondary rays", depth);
    return CT_ERR_SCENE;
  }
  const char *expected = ct_target_breach(v->eye, v->target);
  if (expected) return refuse_triple(fault, "target", expected, v->target);
  expected = ct_up_breach(v->eye, v->target, v->up);
  return expected ? refuse_triple(fault, "up", expected, v->up) : CT_OK;
}

/* The columns of a material from which the delivery's files lack a value. */
static int first_unstated_column(int delivery) {
  return delivery == 1 ? 0 : delivery == 2 ? CT_KR : CT_MATERIAL_COLUMNS;
}

static const struct {
  const char *name;
  ct_rule rule;
} material_columns[CT_MATERIAL_COLUMNS] = {
    {"ka", CT_RULE_COEFFICIENT}, {"kd", CT_RULE_COEFFICIENT}, {"ks", CT_RULE_COEFFICIENT},
    {"eta", CT_RULE_POSITIVE},   {"kr", CT_RULE_COEFFICIENT}, {"kt", CT_RULE_COEFFICIENT},
    {"n", CT_RULE_FINITE}};

/* Whether the object keeps every rule; which it breaks, and its name, is for check_object. */
static int is_sound(const ct_scene_view *v, size_t i) {
  const double *color = v->color + 3 * i, *m = v->material + i * CT_MATERIAL_COLUMNS;
  const double *g = v->geometry + i * CT_GEOMETRY_COLUMNS;
  double unstated[CT_MATERIAL_COLUMNS];
  for (int k = 0; k < 3; k++)
    if (ct_rule_breach(CT_RULE_COLOR, color[k]) || ct_rule_breach(CT_RULE_FINITE, g[k])) return 0;
  ct_default_material(v->delivery, unstated);
  for (int k = 0; k < CT_MATERIAL_COLUMNS; k++)
    if (ct_rule_breach(material_columns[k].rule, m[k]) ||
        (k >= first_unstated_column(v->delivery) && m[k] != unstated[k]))
      return 0;
  if (ct_index_breach(m[CT_KT], m[CT_N])) return 0;
  if (v->kind[i] == CT_SPHERE) return !ct_rule_breach(CT_RULE_POSITIVE, g[3]);
  return v->kind[i] == CT_PLANE && !ct_rule_breach(CT_RULE_FINITE, g[3]) &&
         !ct_rule_breach(CT_RULE_FINITE, g[4]) && !ct_rule_breach(CT_RULE_FINITE, g[5]) &&
         (g[3] != 0 || g[4] != 0 || g[5] != 0);
}

static ct_status check_object(const ct_scene_view *v, size_t i, ct_fault *fault) {
  const double *material = v->material + i * CT_MATERIAL_COLUMNS;
  const double *geometry = v->geometry + i * CT_GEOMETRY_COLUMNS;
  const char *expected;
  double unstated[CT_MATERIAL_COLUMNS];
  char where[64];
  ct_status status;
  snprintf(where, sizeof where, "objects[%zu].color", i);
  if ((status = check(CT_RULE_COLOR, v->color + 3 * i, 3, where, fault))) return status;
  ct_default_material(v->delivery, unstated);
  for (int k = 0; k < CT_MATERIAL_COLUMNS; k++) {
    snprintf(where, sizeof where, "objects[%zu].%s", i, material_columns[k].name);
    expected = ct_rule_breach(material_columns[k].rule, material[k]);
    if (!expected && k >= first_unstated_column(v->delivery) && material[k] != unstated[k])
      expected = "the default, as this delivery's files do not state it";
    if (!expected && k == CT_N) expected = ct_index_breach(material[CT_KT], material[CT_N]);
    if (expected) {
      ct_fault_number(fault, where, expected, material[k]);
      return CT_ERR_SCENE;
    }
  }
  if (v->kind[i] == CT_SPHERE) {
    snprintf(where, sizeof where, "objects[%zu].center", i);
    if ((status = check(CT_RULE_FINITE, geometry, 3, where, fault))) return status;
    snprintf(where, sizeof where, "objects[%zu].radius", i);
    return check(CT_RULE_POSITIVE, geometry + 3, 1, where, fault);
  }
  if (v->kind[i] != CT_PLANE) {
    snprintf(where, sizeof where, "objects[%zu].kind", i);
    ct_fault_number(fault, where, "0 (sphere) or 1 (plane)", v->kind[i]);
    return CT_ERR_SCENE;
  }
  snprintf(where, sizeof where, "objects[%zu].point", i);
  if ((status = check(CT_RULE_FINITE, geometry, 3, where, fault))) return status;
  snprintf(where, sizeof where, "objects[%zu].normal", i);
  if ((status = check(CT_RULE_FINITE, geometry + 3, 3, where, fault))) return status;
  if (geometry[3] == 0 && geometry[4] == 0 && geometry[5] == 0) {
    ct_fault_set(fault, where, "a normal other than 0 0 0", "0 0 0");
    return CT_ERR_SCENE;
  }
  return CT_OK;
}

ct_status ct_scene_check(const ct_scene_view *v, ct_fault *fault) {
  ct_status status;
  if (!v || !fault) return CT_ERR_ARGUMENT;
  memset(fault, 0, sizeof *fault);
  if ((status = check_camera(v, fault))) return status;
  for (size_t i = 0; i < v->n_objects; i++)
    if (!is_sound(v, i) && (status = check_object(v, i, fault))) return status;
  for (size_t i = 0; i < v->n_lights; i++) {
    char where[64];
    snprintf(where, sizeof where, "lights[%zu].color", i);
    if ((status = check(CT_RULE_COLOR, v->lights + 6 * i, 3, where, fault))) return status;
    snprintf(where, sizeof where, "lights[%zu].position", i);
    if ((status = check(CT_RULE_FINITE, v->lights + 6 * i + 3, 3, where, fault))) return status;
  }
  return CT_OK;
}
