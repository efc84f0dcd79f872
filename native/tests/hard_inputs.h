/* The families of hard inputs of each primitive. An input is a row of doubles:
 *   sphere     origin, direction, centre, radius
 *   plane      origin, direction, point, unit normal
 *   refract    wo, normal, cosine, index as over and under
 *   highlight  mirrored direction, wo, eta
 */
#ifndef CT_TESTS_HARD_INPUTS_H
#define CT_TESTS_HARD_INPUTS_H

#include <stddef.h>

typedef struct family {
  const char *name;
  void (*make)(double a, double b, double *input);
  double a, b; /* what make varies */
  /* Greatest error of the compensated form: units in the last place of t, beside 64u^2 r^2/t' for
   * a sphere's other root t'; for refract, u = 2^-53; for highlight, u (1 + |eta ln x|). */
  double allowed;
} family;

extern const family sphere_families[], plane_families[], refract_families[], highlight_families[];
extern const size_t n_sphere_families, n_plane_families, n_refract_families, n_highlight_families;

#endif
