/* A scene given as plain data goes through the same rules as a file, and names the field. */
#include <math.h>
#include <string.h>

#include "check.h"
#include "crosstrace.h"

static uint8_t kind[2] = {CT_SPHERE, CT_PLANE};
static double color[6], material[14], geometry[12], lights[6];

static ct_scene_view good_view(void) {
  ct_scene_view v = {.delivery = 3, .v_res = 2, .h_res = 2, .pixel_size = 1, .screen_distance = 1,
                     .eye = {0, 0, 5}, .up = {0, 1, 0}, .max_depth = 2, .n_objects = 2,
                     .n_lights = 1, .kind = kind, .color = color, .material = material,
                     .geometry = geometry, .lights = lights};
  memset(color, 0, sizeof color);
  memset(lights, 0, sizeof lights);
  memset(geometry, 0, sizeof geometry);
  ct_default_material(3, material);
  ct_default_material(3, material + 7);
  geometry[3] = 1;
  geometry[6 + 5] = 1;
  return v;
}

static void refuses(const ct_scene_view *v, const char *where, const char *found) {
  ct_fault fault;
  CHECK(ct_scene_check(v, &fault) == CT_ERR_SCENE);
  if (strcmp(fault.where, where) || strcmp(fault.found, found) || fault.line) {
    fprintf(stderr, "%s: expected %s, found %s\n", fault.where, fault.expected, fault.found);
    exit(1);
  }
}

int main(void) {
  ct_fault fault;
  ct_scene_view v = good_view();
  CHECK(ct_scene_check(&v, &fault) == CT_OK);
  v.v_res = 0, refuses(&v, "v_res", "0");
  v = good_view(), v.eye[1] = (double)NAN, refuses(&v, "eye[1]", "nan");
  v = good_view(), v.eye[2] = 0, refuses(&v, "target", "0 0 0");
  v = good_view(), v.up[1] = 0, refuses(&v, "up", "0 0 0");
  v = good_view(), v.up[1] = 0, v.up[2] = -3, refuses(&v, "up", "0 0 -3");
  v = good_view(), v.delivery = 2, refuses(&v, "max_depth", "2");
  v = good_view(), color[4] = 256, refuses(&v, "objects[1].color[1]", "256");
  v = good_view(), geometry[3] = -0.1, refuses(&v, "objects[0].radius", "-0.1");
  v = good_view(), geometry[11] = 0, refuses(&v, "objects[1].normal", "0 0 0");
  v = good_view(), material[CT_KT] = 1, material[CT_N] = 0, refuses(&v, "objects[0].n", "0");
  v = good_view(), v.delivery = 2, v.max_depth = 0, material[CT_KR] = 0.5;
  refuses(&v, "objects[0].kr", "0.5");
  v = good_view(), lights[5] = (double)INFINITY, refuses(&v, "lights[0].position[2]", "inf");
  return 0;
}
