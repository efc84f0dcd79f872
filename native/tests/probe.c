/* One precision behind the interface of probe.h. The build defines PROBE_REAL and PROBE_PRIMITIVES,
 * the headers that a kernel would include, and PROBE_RUNG, its name. */
#include "probe.h"

#include <float.h>
#include <stddef.h>

#define JOINED(a, b) a##b
#define JOIN(a, b) JOINED(a, b)
#define TEXT_OF(a) #a
#define TEXT(a) TEXT_OF(a)

#if !defined(PROBE_NEEDS_F80) || defined(HAVE_F80)
#if !defined(PROBE_NEEDS_F128) || defined(HAVE_F128)
#include PROBE_REAL
#include "vector.inc.h"
#include "power.inc.h"
#include PROBE_PRIMITIVES

static void store(REAL x, double out[2]) {
  out[0] = to_double(x);
  out[1] = to_low(x);
}

static void probe_power(double x, double eta, double out[2]) {
  store(power_of(from_double(x), eta), out);
}

static void probe_sphere(const double o[3], const double d[3], const double c[3], double r,
                         double t_min, double out[2]) {
  store(sphere_nearest(v_load(o), v_load(d), v_load(c), from_double(r), 0, from_double(t_min)),
        out);
}

static void probe_plane(const double o[3], const double d[3], const double p[3],
                        const double n[3], double out[2]) {
  store(plane_nearest(v_load(o), v_load(d), v_load(p), v_load(n), from_double(0)), out);
}

static int probe_refraction(const double wo[3], const double n[3], double cosine, double over,
                            double under, double out[3]) {
  VEC v = v_zero();
  INDEX index = {from_double(over), from_double(under)};
  int passes = refract(v_load(wo), v_load(n), from_double(cosine), index, &v);
  v_store(v, out);
  return passes;
}

static double probe_highlight(const double r[3], const double wo[3], double eta) {
  return to_double(highlight(v_load(r), v_load(wo), eta));
}

const probe JOIN(probe_, PROBE_RUNG) = {
    TEXT(PROBE_RUNG), REAL_DIGITS,      REAL_UNIT,      probe_power, probe_sphere,
    probe_plane,      probe_refraction, probe_highlight};

static int truth_sphere(const double o[3], const double d[3], const double c[3], double r,
                        double roots[2][2]) {
  VEC f = v_sub(v_load(o), v_load(c)), direction = v_load(d);
  REAL a = v_dot(direction, direction), b = neg(v_dot(f, direction)), zero = from_double(0);
  REAL rest = sub(v_dot(f, f), mul(from_double(r), from_double(r)));
  REAL disc = sub(mul(b, b), mul(a, rest));
  if (less(disc, zero)) return 0;
  REAL s = root(disc), q = less(b, zero) ? sub(b, s) : add(b, s);
  REAL one = quo(q, a), other = less(zero, magnitude(q)) ? quo(rest, q) : zero;
  store(less(one, other) ? one : other, roots[0]);
  store(less(one, other) ? other : one, roots[1]);
  return 2;
}

static int truth_plane(const double o[3], const double d[3], const double p[3],
                       const double n[3], double out[2]) {
  REAL slope = v_dot(v_load(d), v_load(n));
  if (!less(from_double(0), magnitude(slope))) return 0;
  store(quo(v_dot(v_sub(v_load(p), v_load(o)), v_load(n)), slope), out);
  return 1;
}

static int truth_refraction(const double wo[3], const double n[3], double cosine, double over,
                            double under, double out[3]) {
  REAL one = from_double(1), c = from_double(cosine);
  REAL ratio = quo(from_double(under), from_double(over));
  /* Cleared of its denominator, so that the sign is exact. */
  REAL delta = add(sub(mul(from_double(over), from_double(over)),
                       mul(from_double(under), from_double(under))),
                   mul(mul(from_double(under), c), mul(from_double(under), c)));
  if (less(delta, from_double(0))) return 0;
  REAL along = sub(quo(root(delta), from_double(over)), mul(ratio, c));
  VEC t = v_neg(v_add(v_scale(ratio, v_load(wo)), v_scale(mul(one, along), v_load(n))));
  v_store(t, out);
  return 1;
}

static void truth_highlight(const double r[3], const double wo[3], double eta, double out[2],
                            double *exponent) {
  VEC a = v_load(r), b = v_load(wo);
  REAL x = quo(v_dot(a, b), mul(v_length(a), v_length(b)));
  out[0] = out[1] = *exponent = 0;
  if (!less(from_double(0), x)) return;
  REAL log_x = log_of(x);
  *exponent = eta * to_double(log_x);
  store(exponential_power(log_x, eta), out);
}

const truth JOIN(truth_, PROBE_RUNG) = {truth_sphere, truth_plane, truth_refraction,
                                        truth_highlight};
#endif
#endif
