/* What makes a scene meaningful (design, section 4): one table for text and for plain data. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "text.h"

const char *ct_rule_breach(ct_rule rule, double value) {
  if (!isfinite(value)) return "a finite number";
  switch (rule) {
    case CT_RULE_FINITE:
      return fabs(value) <= CT_LARGEST ? NULL : "a magnitude of at most 1e100";
    case CT_RULE_POSITIVE:
      if (value > CT_LARGEST) return "a number of at most 1e100";
      return value > 0 ? NULL : "a number greater than 0";
    case CT_RULE_COLOR:
      return value >= 0 && value <= 255 ? NULL : "a colour from 0 to 255";
    case CT_RULE_COEFFICIENT:
      return value >= 0 && value <= 1 ? NULL : "a coefficient from 0 to 1";
    case CT_RULE_RESOLUTION:
      return value >= 1 && value <= CT_LARGEST_SIDE && value == floor(value)
                 ? NULL
                 : "an integer from 1 to 1048576";
    case CT_RULE_COUNT:
      return value >= 0 && value <= 2147483647.0 && value == floor(value)
                 ? NULL
                 : "an integer from 0 to 2147483647";
  }
  return NULL;
}

/* a*b - c*d with one rounding's worth of error in the products (Kahan), scaled by the caller. */
static double difference_of_products(double a, double b, double c, double d) {
  double cd = c * d;
  double error = fma(-c, d, cd);
  return fma(a, b, -cd) + error;
}

/* Is the view parallel to `up`? Decided on the exact doubles: E - L is hi + lo without error, and
 * the cross product is compared with 2^-100 of the product of the lengths. */
static int is_parallel(const double eye[3], const double target[3], const double up[3]) {
  double hi[3], lo[3], u[3], scale = 0, up_scale = 0;
  for (int i = 0; i < 3; i++) {
    hi[i] = eye[i] - target[i];
    double back = hi[i] - eye[i];
    lo[i] = (eye[i] - (hi[i] - back)) + (-target[i] - back);
    scale = fmax(scale, fabs(hi[i]));
    up_scale = fmax(up_scale, fabs(up[i]));
  }
  int shift = -ilogb(scale), up_shift = -ilogb(up_scale);
  for (int i = 0; i < 3; i++) {
    hi[i] = ldexp(hi[i], shift);
    lo[i] = ldexp(lo[i], shift);
    u[i] = ldexp(up[i], up_shift);
  }
  for (int i = 0; i < 3; i++) {
    int j = (i + 1) % 3, k = (i + 2) % 3;
    double component = difference_of_products(u[j], hi[k], u[k], hi[j]);
    component += difference_of_products(u[j], lo[k], u[k], lo[j]);
    if (fabs(component) > 0x1p-100) return 0;
  }
  return 1;
}

const char *ct_target_breach(const double e[3], const double l[3]) {
  return e[0] == l[0] && e[1] == l[1] && e[2] == l[2] ? "a target L other than the eye E" : NULL;
}

const char *ct_up_breach(const double eye[3], const double target[3], const double up[3]) {
  if (up[0] == 0 && up[1] == 0 && up[2] == 0) return "an up vector other than 0 0 0";
  return is_parallel(eye, target, up) ? "an up vector that is not parallel to the view" : NULL;
}

const char *ct_index_breach(double kt, double n) {
  return kt > 0 && !(n > 0) ? "an index of refraction n > 0, as kt > 0" : NULL;
}

void ct_fault_set(ct_fault *fault, const char *where, const char *expected, const char *found) {
  if (!fault) return;
  snprintf(fault->where, sizeof fault->where, "%s", where);
  snprintf(fault->expected, sizeof fault->expected, "%s", expected);
  snprintf(fault->found, sizeof fault->found, "%s", found);
}

void ct_fault_phrase(char *out, size_t size, const char *expected, const char *what) {
  snprintf(out, size, *what ? "%s (%s)" : "%s", expected, what);
}

void ct_fault_number(ct_fault *fault, const char *where, const char *expected, double found) {
  char text[40];
  /* The shortest of the usual lengths that still names this very double. */
  for (int digits = 6; digits <= 17; digits++) {
    snprintf(text, sizeof text, "%.*g", digits, found);
    double back = 0;
    if (sscanf(text, "%lf", &back) == 1 && back == found) break;
  }
  /* The process may have chosen a locale with another decimal mark. */
  for (char *c = text; *c; c++)
    if (*c == ',') *c = '.';
  ct_fault_set(fault, where, expected, text);
}
