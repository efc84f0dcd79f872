/* The table of readings: every named alternative meaning of the specification, and its default.
 *
 * The first value of a choice is its default. A reading is set by its text, so that the same names
 * serve the command line, Python and C.
 */
#define _GNU_SOURCE
#include "options.h"

#include <locale.h>
#include <stdlib.h>
#include <string.h>

#include "text.h"

/* double: ct_precision_name(1) */
enum { DEFAULT_PRECISION = 1 };

/* Far above any real picture, near enough to end a runaway tree: about ten minutes of rays. */
#define DEFAULT_RAY_BUDGET (UINT64_C(1) << 34)

static const struct {
  const char *name, *standard, *values;
} table[] = {
    [CT_MIX] = {"mix", "sum", "sum|convex"},
    [CT_PLANE_NORMAL] = {"plane_normal", "unit", "unit|raw"},
    [CT_LIGHTING_NORMAL] = {"lighting_normal", "given", "given|facing"},
    [CT_VIEW] = {"view", "ray", "ray|eye"},
    [CT_SPECULAR_GATE] = {"specular_gate", "none", "none|lit"},
    [CT_GLASS_SHADOW] = {"glass_shadow", "opaque", "opaque|clear"},
    [CT_SHADOW_DISTANCE] = {"shadow_distance", "light", "light|ignored"},
    [CT_OFFSET] = {"offset", "direction", "direction|normal|bound|mitsuba"},
    [CT_EPSILON_TWICE] = {"epsilon_twice", "no", "no|yes"},
    [CT_EPSILON_FOR] = {"epsilon_for", "all", "all|shadow"},
    [CT_DEPTH] = {"depth", "as-given", "as-given|minus-one|plus-one"},
    [CT_EXHAUSTED] = {"exhausted", "black", "black|background"},
    [CT_MISS] = {"miss", "background", "background|black"},
    [CT_SIDE] = {"refraction", "relative", "relative|inverted|one-way"},
    [CT_NESTING] = {"nesting", "relative", "relative|tracked|interiors"},
    [CT_TIR] = {"tir", "replace", "replace|ignore|add|plus-one|needs-kr|always"},
    [CT_INNER_REFLECTION] = {"inner_reflection", "on", "on|off"},
    [CT_RECURSION] = {"recursion", "free", "free|clamp|scale"},
    [CT_INDEX] = {"index", "exact", "exact|float32"},
    /* Numeric readings. */
    [CT_N_CHOICES] = {"epsilon", "1e-5", "NUMBER"},
    [CT_N_CHOICES + 1] = {"shadow_min", "0", "NUMBER"},
    [CT_N_CHOICES + 2] = {"light_min", "0", "NUMBER"},
    [CT_N_CHOICES + 3] = {"far", "0", "NUMBER"},
};

enum { N_READINGS = sizeof table / sizeof *table };

const char *ct_reading_name(size_t index) { return index < N_READINGS ? table[index].name : NULL; }
const char *ct_reading_values(size_t index) {
  return index < N_READINGS ? table[index].values : NULL;
}
const char *ct_reading_default(size_t index) {
  return index < N_READINGS ? table[index].standard : NULL;
}

ct_options *ct_options_new(void) {
  ct_options *options = calloc(1, sizeof *options);
  if (!options) return NULL;
  options->epsilon = 1e-5;
  options->precision = DEFAULT_PRECISION;
  options->instructions = CT_INSTRUCTIONS_NATIVE;
  options->effects = CT_ALL_EFFECTS;
  options->ray_budget = DEFAULT_RAY_BUDGET;
  return options;
}

void ct_options_free(ct_options *options) { free(options); }

static ct_status refuse(ct_fault *fault, const char *name, const char *expected,
                        const char *found) {
  if (fault) memset(fault, 0, sizeof *fault);
  ct_fault_set(fault, name, expected, found);
  return CT_ERR_OPTION;
}

/* The index of a value in "a|b|c", or -1. */
static int find_value(const char *values, const char *value) {
  size_t n = strlen(value);
  for (int i = 0; *values; i++) {
    size_t length = strcspn(values, "|");
    if (length == n && memcmp(values, value, n) == 0) return i;
    values += length + (values[length] == '|');
  }
  return -1;
}

static ct_status set_number(ct_options *options, size_t index, const char *value,
                            ct_fault *fault) {
  double number = 0;
  locale_t c_locale = newlocale(LC_NUMERIC_MASK, "C", (locale_t)0);
  if (!c_locale) return CT_ERR_MEMORY;
  int outcome = ct_read_number(value, strlen(value), c_locale, &number);
  freelocale(c_locale);
  if (outcome == CT_NUMBER_NO_MEMORY) return CT_ERR_MEMORY;
  if (outcome != CT_NUMBER_OK || number < 0 || number > CT_LARGEST)
    return refuse(fault, table[index].name, "a number from 0 to 1e100", value);
  double *fields[] = {&options->epsilon, &options->shadow_min, &options->light_min,
                      &options->far};
  *fields[index - CT_N_CHOICES] = number;
  return CT_OK;
}

ct_status ct_options_set(ct_options *options, const char *name, const char *value,
                         ct_fault *fault) {
  if (!options || !name || !value) return CT_ERR_ARGUMENT;
  for (size_t i = 0; i < N_READINGS; i++) {
    if (strcmp(table[i].name, name) != 0) continue;
    if (i >= CT_N_CHOICES) return set_number(options, i, value, fault);
    int choice = find_value(table[i].values, value);
    if (choice < 0) return refuse(fault, name, table[i].values, value);
    options->choice[i] = choice;
    return CT_OK;
  }
  return refuse(fault, name, "the name of a reading", name);
}

ct_status ct_options_set_precision(ct_options *options, const char *name, ct_fault *fault) {
  char present[sizeof fault->expected] = "";
  const char *other;
  if (!options || !name) return CT_ERR_ARGUMENT;
  for (size_t i = 0; (other = ct_precision_name(i)) != NULL; i++) {
    if (strcmp(other, name) == 0) {
      options->precision = i;
      return CT_OK;
    }
    size_t n = strlen(present);
    if (n + strlen(other) + 2 > sizeof present) continue;
    if (i > 0) present[n++] = '|';
    memcpy(present + n, other, strlen(other) + 1);
  }
  return refuse(fault, "precision", present, name);
}

ct_status ct_options_set_rounding(ct_options *options, const char *mode, ct_fault *fault) {
  static const char modes[] = "nearest|up|down|zero";
  if (!options || !mode) return CT_ERR_ARGUMENT;
  int found = find_value(modes, mode);
  if (found < 0) return refuse(fault, "rounding", modes, mode);
  options->rounding = found;
  return CT_OK;
}

ct_status ct_options_set_instructions(ct_options *options, const char *most, ct_fault *fault) {
  static const char sets[] = "scalar|generic|fma|avx2|avx512|native";
  if (!options || !most) return CT_ERR_ARGUMENT;
  int found = find_value(sets, most);
  if (found < 0) return refuse(fault, "instructions", sets, most);
  options->instructions = (ct_instructions)found;
  return CT_OK;
}

ct_status ct_options_set_search(ct_options *options, const char *way, ct_fault *fault) {
  static const char ways[] = "auto|scan|tree";
  if (!options || !way) return CT_ERR_ARGUMENT;
  int found = find_value(ways, way);
  if (found < 0) return refuse(fault, "search", ways, way);
  options->search = found;
  return CT_OK;
}

void ct_options_set_tree(ct_options *options, const ct_tree *tree) { options->tree = tree; }

ct_status ct_options_set_tolerance(ct_options *options, double tolerance, ct_fault *fault) {
  if (!options) return CT_ERR_ARGUMENT;
  if (!(tolerance >= 0 && tolerance <= CT_LARGEST))
    return refuse(fault, "tolerance", "a number from 0 to 1e100", "another");
  options->tolerance = tolerance;
  return CT_OK;
}

void ct_options_set_effects(ct_options *options, unsigned mask) { options->effects = mask; }
void ct_options_set_threads(ct_options *options, unsigned n) { options->n_threads = n; }
void ct_options_set_ray_budget(ct_options *options, uint64_t n) { options->ray_budget = n; }
void ct_options_set_jitter(ct_options *options, uint64_t seed) { options->jitter = seed; }
void ct_options_set_rows(ct_options *options, int64_t begin, int64_t end) {
  options->row_begin = begin;
  options->row_end = end;
}

int64_t ct_effective_depth(const ct_scene_view *view, const ct_options *options) {
  unsigned secondary = CT_REFLECTION | CT_REFRACTION | CT_TOTAL_REFLECTION;
  if (view->delivery < 3 || !(options->effects & secondary)) return 0;
  int64_t shift = options->choice[CT_DEPTH] == CT_DEPTH_MINUS_ONE  ? -1
                  : options->choice[CT_DEPTH] == CT_DEPTH_PLUS_ONE ? 1
                                                                   : 0;
  int64_t depth = view->max_depth + shift;
  return depth > 0 ? depth : 0;
}
