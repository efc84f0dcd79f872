/* The course's scene format, all three deliveries (specification 2.4, 3.4, 4.3).
 *
 * A file is a sequence of numbers and the signs * and /; line breaks carry no meaning. The delivery
 * is told by how many numbers stand between the 16 of the header and the first sign: 4, 8 or 12;
 * without an object, by how many follow the header: 1, 5 + 6k or 6 + 6k. One pass checks each
 * number as it is read, so that the first fault in the file is the one reported.
 */
#include <stdlib.h>
#include <string.h>

#include "lexer.h"
#include "machine.h"
#include "scene.h"

typedef struct reader {
  ct_lexer lexer;
  ct_fault *fault;
} reader;

static ct_status read_number(reader *r, const char *what, ct_rule rule, double *value) {
  const char *expected = "a number";
  if (!ct_lexer_at_end(&r->lexer) && !ct_lexer_at_sign(&r->lexer)) {
    switch (ct_read_number(r->lexer.token, r->lexer.token_bytes, r->lexer.c_locale, value)) {
      case CT_NUMBER_OK: expected = ct_rule_breach(rule, *value); break;
      case CT_NUMBER_OVERFLOW: expected = "a number that a double can hold"; break;
      case CT_NUMBER_NO_MEMORY: return CT_ERR_MEMORY;
      default: break;
    }
  }
  if (expected) {
    char phrase[sizeof r->fault->expected];
    ct_fault_phrase(phrase, sizeof phrase, expected, what);
    return ct_lexer_refuse(&r->lexer, r->fault, what, phrase);
  }
  ct_lexer_advance(&r->lexer);
  return CT_OK;
}

static ct_status read_numbers(reader *r, const char *what, ct_rule rule, double *values,
                              size_t n) {
  ct_status status = CT_OK;
  for (size_t i = 0; i < n && !status; i++) status = read_number(r, what, rule, values + i);
  return status;
}

static ct_status read_integer(reader *r, const char *what, ct_rule rule, int64_t *value) {
  double number = 0;
  ct_status status = read_number(r, what, rule, &number);
  if (!status) *value = (int64_t)number; /* in range: the rule has been kept */
  return status;
}

static ct_status read_header(reader *r, ct_scene_view *v) {
  ct_status status;
  if ((status = read_integer(r, "v_res", CT_RULE_RESOLUTION, &v->v_res)) ||
      (status = read_integer(r, "h_res", CT_RULE_RESOLUTION, &v->h_res)) ||
      (status = read_number(r, "the pixel size s", CT_RULE_POSITIVE, &v->pixel_size)) ||
      (status = read_number(r, "the distance d", CT_RULE_POSITIVE, &v->screen_distance)) ||
      (status = read_numbers(r, "the eye E", CT_RULE_FINITE, v->eye, 3)))
    return status;
  ct_lexer at_target = r->lexer;
  if ((status = read_numbers(r, "the target L", CT_RULE_FINITE, v->target, 3))) return status;
  const char *expected = ct_target_breach(v->eye, v->target);
  if (expected) return ct_lexer_refuse(&at_target, r->fault, "target", expected);
  ct_lexer at_up = r->lexer;
  if ((status = read_numbers(r, "up", CT_RULE_FINITE, v->up, 3))) return status;
  expected = ct_up_breach(v->eye, v->target, v->up);
  if (expected) return ct_lexer_refuse(&at_up, r->fault, "up", expected);
  return read_numbers(r, "the background colour", CT_RULE_COLOR, v->background, 3);
}

/* Looks ahead, without moving, how many numbers stand before the first sign or the end. Anything
 * that is no number is refused here, since what follows it cannot be counted on. */
static ct_status tell_delivery(reader *r, int *delivery) {
  reader ahead = *r;
  size_t n = 0;
  for (; !ct_lexer_at_end(&ahead.lexer) && !ct_lexer_at_sign(&ahead.lexer); n++) {
    double ignored = 0;
    int fault = ct_read_number(ahead.lexer.token, ahead.lexer.token_bytes, r->lexer.c_locale,
                               &ignored);
    if (fault == CT_NUMBER_NO_MEMORY) return CT_ERR_MEMORY;
    if (fault == CT_NUMBER_MALFORMED)
      return ct_lexer_refuse(&ahead.lexer, r->fault, "", "a number, * or /");
    ct_lexer_advance(&ahead.lexer);
  }
  if (ct_lexer_at_sign(&ahead.lexer)) {
    *delivery = n == 4 ? 1 : n == 8 ? 2 : n == 12 ? 3 : 0;
    if (*delivery) return CT_OK;
    return ct_lexer_refuse(&ahead.lexer, r->fault, "",
                           "4, 8 or 12 numbers (delivery 1, 2 or 3) between the background "
                           "colour and the first * or /");
  }
  *delivery = n == 1 ? 1 : n % 6 == 5 ? 2 : n >= 6 && n % 6 == 0 ? 3 : 0;
  if (*delivery) return CT_OK;
  return ct_lexer_refuse(&ahead.lexer, r->fault, "",
                         "1, 5 + 6k or 6 + 6k numbers (delivery 1, 2 or 3, no object, k lights) "
                         "after the background colour");
}

static ct_status read_material(reader *r, int delivery, double *m) {
  ct_status status;
  ct_default_material(delivery, m);
  if (delivery == 1) return CT_OK;
  if ((status = read_number(r, "ka", CT_RULE_COEFFICIENT, m + CT_KA)) ||
      (status = read_number(r, "kd", CT_RULE_COEFFICIENT, m + CT_KD)) ||
      (status = read_number(r, "ks", CT_RULE_COEFFICIENT, m + CT_KS)) ||
      (status = read_number(r, "the exponent eta", CT_RULE_POSITIVE, m + CT_ETA)))
    return status;
  if (delivery == 2) return CT_OK;
  if ((status = read_number(r, "kr", CT_RULE_COEFFICIENT, m + CT_KR)) ||
      (status = read_number(r, "kt", CT_RULE_COEFFICIENT, m + CT_KT)))
    return status;
  ct_lexer at_index = r->lexer;
  if ((status = read_number(r, "the index n", CT_RULE_FINITE, m + CT_N))) return status;
  const char *expected = ct_index_breach(m[CT_KT], m[CT_N]);
  return expected ? ct_lexer_refuse(&at_index, r->fault, "n", expected) : CT_OK;
}

static ct_status read_geometry(reader *r, uint8_t *kind, double *g) {
  ct_status status;
  memset(g, 0, CT_GEOMETRY_COLUMNS * sizeof *g);
  if (!ct_lexer_at_sign(&r->lexer))
    return ct_lexer_refuse(&r->lexer, r->fault, "", "* (a sphere) or / (a plane)");
  *kind = *r->lexer.token == '*' ? CT_SPHERE : CT_PLANE;
  ct_lexer_advance(&r->lexer);
  if (*kind == CT_SPHERE) {
    if ((status = read_numbers(r, "the centre", CT_RULE_FINITE, g, 3))) return status;
    return read_number(r, "the radius", CT_RULE_POSITIVE, g + 3);
  }
  if ((status = read_numbers(r, "the point", CT_RULE_FINITE, g, 3))) return status;
  ct_lexer at_normal = r->lexer;
  if ((status = read_numbers(r, "the normal", CT_RULE_FINITE, g + 3, 3))) return status;
  if (g[3] == 0 && g[4] == 0 && g[5] == 0)
    return ct_lexer_refuse(&at_normal, r->fault, "normal", "a normal other than 0 0 0");
  return CT_OK;
}

/* An upper bound of the objects in the rest of the text, so that an impossible count costs no
 * memory: each has one sign. */
static size_t count_signs(const ct_lexer *lexer) {
  size_t n = 0;
  for (const char *p = lexer->token; p < lexer->end; p++) n += *p == '*' || *p == '/';
  return n;
}

static ct_status read_objects(reader *r, ct_scene *scene, size_t n) {
  ct_scene_view *v = &scene->view;
  size_t n_possible = count_signs(&r->lexer);
  ct_status status = ct_scene_reserve_objects(scene, n < n_possible ? n : n_possible + 1);
  if (status) return status;
  for (size_t i = 0; i < n; i++) {
    if ((status = read_numbers(r, "the object's colour", CT_RULE_COLOR, scene->color + 3 * i, 3)) ||
        (status = read_material(r, v->delivery, scene->material + i * CT_MATERIAL_COLUMNS)) ||
        (status = read_geometry(r, scene->kind + i, scene->geometry + i * CT_GEOMETRY_COLUMNS)))
      return status;
    v->n_objects = i + 1;
  }
  return CT_OK;
}

static ct_status read_lights(reader *r, ct_scene *scene) {
  ct_scene_view *v = &scene->view;
  int64_t n = 0;
  ct_status status;
  if ((status = read_numbers(r, "the ambient light", CT_RULE_COLOR, v->ambient, 3)) ||
      (status = read_integer(r, "the number of lights", CT_RULE_COUNT, &n)))
    return status;
  /* A light takes at least 12 bytes of text. */
  size_t n_possible = (size_t)(r->lexer.end - r->lexer.token) / 12 + 1;
  if ((status = ct_scene_reserve_lights(scene, (size_t)n < n_possible ? (size_t)n : n_possible)))
    return status;
  for (size_t i = 0; i < (size_t)n; i++) {
    double light[CT_LIGHT_COLUMNS];
    if ((status = read_numbers(r, "the light's colour", CT_RULE_COLOR, light, 3)) ||
        (status = read_numbers(r, "the light's position", CT_RULE_FINITE, light + 3, 3)))
      return status;
    memcpy(scene->lights + i * CT_LIGHT_COLUMNS, light, sizeof light);
    v->n_lights = i + 1;
  }
  return CT_OK;
}

static ct_status read_scene(reader *r, int delivery, ct_scene *scene) {
  ct_scene_view *v = &scene->view;
  int64_t n_objects = 0;
  ct_status status = read_header(r, v);
  if (status) return status;
  if (!delivery && (status = tell_delivery(r, &delivery))) return status;
  v->delivery = delivery;
  if (delivery == 3 && (status = read_integer(r, "max_depth", CT_RULE_COUNT, &v->max_depth)))
    return status;
  if ((status = read_integer(r, "the number of objects", CT_RULE_COUNT, &n_objects)) ||
      (status = read_objects(r, scene, (size_t)n_objects)))
    return status;
  v->ambient[0] = v->ambient[1] = v->ambient[2] = 255;
  if (delivery > 1 && (status = read_lights(r, scene))) return status;
  if (!ct_lexer_at_end(&r->lexer))
    return ct_lexer_refuse(&r->lexer, r->fault, "", "end of file");
  return CT_OK;
}

ct_status ct_scene_parse(const char *text, size_t n_bytes, int delivery, ct_scene **out,
                         ct_fault *fault) {
  if (!out || !fault || (!text && n_bytes) || delivery < 0 || delivery > 3)
    return CT_ERR_ARGUMENT;
  *out = NULL;
  memset(fault, 0, sizeof *fault);
  ct_scene *scene = calloc(1, sizeof *scene);
  if (!scene) return CT_ERR_MEMORY;
  ct_machine_state caller = ct_machine_enter();
  reader r = {.fault = fault};
  ct_status status = ct_lexer_open(&r.lexer, text ? text : "", n_bytes);
  if (!status) {
    status = read_scene(&r, delivery, scene);
    ct_lexer_close(&r.lexer);
  }
  ct_machine_leave(caller);
  if (status) {
    ct_scene_free(scene);
    return status;
  }
  *out = scene;
  return CT_OK;
}
