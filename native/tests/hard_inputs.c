/* Generators of hard inputs: see hard_inputs.h. Inputs are rounded as they come; the truth is that
 * of the rounded numbers. */
#include "hard_inputs.h"

#include <math.h>
#include <string.h>

#include "random.h"

#define COUNT(table) (sizeof table / sizeof *table)

static void along(const double from[3], double t, const double d[3], double out[3]) {
  for (int k = 0; k < 3; k++) out[k] = from[k] + t * d[k];
}

static void normalise(double a[3]) {
  double length = sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
  for (int k = 0; k < 3; k++) a[k] /= length;
}

/* ---- Sphere ---- */

/* From `distance` radii away, passing the centre at `impact` radii. */
static void aim(double distance, double impact, double *input) {
  double *o = input, *d = input + 3, *c = input + 6, across[3], closest[3];
  double r = input[9] = uniform_in(0.5, 2);
  for (int k = 0; k < 3; k++) c[k] = uniform_in(-10, 10);
  random_direction(d);
  random_normal_to(d, across);
  along(c, impact * r, across, closest);
  along(closest, -r * sqrt(distance * distance - impact * impact), d, o);
}

static void from_afar(double distance, double unused, double *input) {
  (void)unused;
  aim(distance, uniform_in(0, 1.2), input);
}

static void grazing(double gap, double distance, double *input) {
  double sign = uniform() < 0.5 ? -1 : 1;
  aim(distance, 1 + sign * gap * uniform_in(0.5, 1), input);
}

static void over_ground(double radius, double unused, double *input) {
  (void)unused;
  for (int k = 0; k < 3; k++) input[k] = uniform_in(-10, 10);
  input[2] = exponential_in(0.01, 10);
  random_direction(input + 3);
  input[6] = input[7] = 0;
  input[8] = -radius;
  input[9] = radius;
}

static void from_inside(double most, double unused, double *input) {
  double way[3];
  (void)unused;
  aim(2, 0, input);
  random_direction(way);
  along(input + 6, input[9] * uniform_in(0, most), way, input);
}

/* On the surface to rounding, then `step` along the ray; inward or outward by the sign. */
static void on_surface(double sign, double step, double *input) {
  double way[3], *d = input + 3;
  from_inside(1, 0, input);
  random_direction(way);
  along(input + 6, input[9], way, input);
  if ((d[0] * way[0] + d[1] * way[1] + d[2] * way[2]) * sign < 0)
    for (int k = 0; k < 3; k++) d[k] = -d[k];
  along(input, step, d, input);
}

const family sphere_families[] = {
    {"near, D/r = 5", from_afar, 5, 0, 1},
    {"far, D/r = 1e3", from_afar, 1e3, 0, 1},
    {"far, D/r = 1e5", from_afar, 1e5, 0, 1},
    {"far, D/r = 1e8", from_afar, 1e8, 0, 1},
    {"grazing to 1e-6", grazing, 1e-6, 5, 1},
    {"grazing to 1e-12", grazing, 1e-12, 5, 1},
    {"grazing to 1e-6 from afar", grazing, 1e-6, 1e6, 1},
    {"ground, r = 1e6", over_ground, 1e6, 0, 1},
    {"ground, r = 1e8", over_ground, 1e8, 0, 1},
    {"origin inside", from_inside, 0.999, 0, 1},
    {"origin on surface, inward", on_surface, -1, 0, 1},
    {"origin on surface, outward", on_surface, 1, 0, 1},
    {"1e-5 off surface, inward", on_surface, -1, 1e-5, 1},
    {"1e-5 off surface, outward", on_surface, 1, 1e-5, 1},
};
const size_t n_sphere_families = COUNT(sphere_families);

/* ---- Plane ---- */

static void slanted(double slope, double reach, double *input) {
  double *o = input, *d = input + 3, *p = input + 6, *n = input + 9, across[3];
  for (int k = 0; k < 3; k++) {
    p[k] = uniform_in(-reach, reach);
    o[k] = p[k] + uniform_in(-10, 10);
  }
  random_direction(n);
  random_normal_to(n, across);
  double sign = uniform() < 0.5 ? -1 : 1;
  along(across, sign * slope * uniform_in(0.5, 1), n, d);
  normalise(d);
}

const family plane_families[] = {
    {"generic", slanted, 1, 10, 1},
    {"far from the coordinates' origin", slanted, 1, 1e6, 1},
    {"grazing, d.n = 1e-3", slanted, 1e-3, 10, 1},
    {"grazing, d.n = 1e-6", slanted, 1e-6, 10, 1},
    {"grazing, d.n = 1e-9", slanted, 1e-9, 10, 1},
    {"grazing, d.n = 1e-12", slanted, 1e-12, 10, 1},
};
const size_t n_plane_families = COUNT(plane_families);

/* ---- Refraction ---- */

static void set_refraction(double cosine, double over, double under, double *input) {
  double *wo = input, *n = input + 3, across[3], sine = sqrt(1 - cosine * cosine);
  random_direction(n);
  random_normal_to(n, across);
  for (int k = 0; k < 3; k++) wo[k] = cosine * n[k] + sine * across[k];
  input[6] = cosine;
  input[7] = over;
  input[8] = under;
}

static void anywhere(double least, double most, double *input) {
  double index = uniform_in(least, most);
  int leaves = uniform() < 0.5;
  set_refraction(uniform(), leaves ? 1 : index, leaves ? index : 1, input);
}

/* |Delta| about `delta`. */
static void critical(double delta, double unused, double *input) {
  double index = uniform_in(1.05, 2.5), sign = uniform() < 0.5 ? -1 : 1;
  (void)unused;
  double sine2 = (1 - sign * delta * uniform_in(0.5, 1)) / (index * index);
  set_refraction(sqrt(1 - sine2), 1, index, input);
}

static void flat(double gap, double cosine, double *input) {
  double index = 1 + gap * uniform_in(-1, 1);
  set_refraction(cosine * uniform(), index, 1, input);
}

const family refract_families[] = {
    {"generic", anywhere, 1.05, 2.5, 5},
    {"|Delta| = 1e-7", critical, 1e-7, 0, 5},
    {"|Delta| = 1e-14", critical, 1e-14, 0, 5},
    {"n = 1 +- 1e-6, flat", flat, 1e-6, 1e-2, 5},
    {"n = 1 +- 1e-12, flat", flat, 1e-12, 1e-5, 5},
};
const size_t n_refract_families = COUNT(refract_families);

/* ---- Highlight ---- */

/* Where eta ln x is about -reach at most, the visible part of a highlight. */
static void shining(double eta, double reach, double *input) {
  double angle = sqrt(2 * uniform_in(0, reach) / eta), across[3];
  if (angle > 1.4) angle = 1.4;
  random_direction(input + 3);
  random_normal_to(input + 3, across);
  for (int k = 0; k < 3; k++) input[k] = cos(angle) * input[3 + k] + sin(angle) * across[k];
  input[6] = eta;
}

const family highlight_families[] = {
    {"eta = 20", shining, 20, 6, 8},     {"eta = 37.5", shining, 37.5, 6, 8},
    {"eta = 200", shining, 200, 6, 8},   {"eta = 1e4", shining, 1e4, 6, 8},
    {"eta = 1e6", shining, 1e6, 6, 8},   {"eta = 1e6, dark", shining, 1e6, 600, 8},
};
const size_t n_highlight_families = COUNT(highlight_families);
