/* Intersection, refraction and highlight with compensated arithmetic (double_word.inc.h): same
 * interface and special cases as prim_plain.inc.h. u = REAL_UNIT.
 *
 * The direction is taken as it stands, |d|^2 = 1 + e with e a few u, so that a root is that of the
 * rounded inputs, not of a line that they almost describe.
 */
#include "double_word.inc.h"

static inline REAL v_sum_of_magnitudes(VEC a) {
  return add(add(magnitude(a.x), magnitude(a.y)), magnitude(a.z));
}

/* Does the ray surely miss the sphere? In plain arithmetic, with F = |f.x| + |f.y| + |f.z|: b is
 * wrong by less than 5uF, c by less than 8u(|f|^2 + r^2), and each component of f + b*d by less
 * than 12uF, so its length by less than 24uF. */
static inline int sphere_surely_missed(VEC f, VEC direction, REAL radius) {
  REAL b = neg(v_dot(f, direction)), r2 = mul(radius, radius), f2 = v_dot(f, f);
  REAL sum = v_sum_of_magnitudes(f);
  if (less(b, mul(from_double(-8 * REAL_UNIT), sum)) &&
      less(mul(from_double(16 * REAL_UNIT), add(f2, r2)), sub(f2, r2)))
    return 1; /* outside and moving away */
  VEC l = v_along(f, b, direction);
  REAL reach = add(radius, mul(from_double(32 * REAL_UNIT), sum));
  return less(mul(from_double(1 + 16 * REAL_UNIT), mul(reach, reach)), v_dot(l, l));
}

/* Sphere: f = o - c exactly; b = -f.d, c = |f|^2 - r^2 and disc = r^2 - |f + b*d|^2 in
 * double-words, so that neither distance (D/r to 1e8), nor a radius of 1e8, nor a ray that grazes
 * to 1e-12 costs digits; then citardauq as in the plain form, its quotient corrected. Error of a
 * root t beside t': below 1 ulp (measured: 0.51) + 64u^2 r^2/|t'|. The second part counts only
 * where the origin lies on the surface to rounding: t is then some u r itself, with a few hundred
 * of its ulp and the right sign. No hit is invented or lost while |disc| > 2^-100 r^2. */
static inline int sphere_roots(VEC origin, VEC direction, VEC center, REAL radius, int on_surface,
                               REAL t[2]) {
  REAL zero = from_double(0), one = from_double(1);
  DW3 f = dw3_difference(origin, center);
  VEC plain_f = v_make(f.x.h, f.y.h, f.z.h);
  if (!on_surface && sphere_surely_missed(plain_f, direction, radius)) return 0;
  DW a = dw_dot(direction, direction), r2 = dw_two_product(radius, radius);
  REAL e = add(sub(a.h, one), a.l);
  /* -f.d / |d|^2: e is so small that its first power is enough. */
  DW b = dw_neg(dw3_dot(f, direction));
  b = dw_sub(b, dw_times(b, e));
  if (on_surface) {
    REAL far = add(b.h, b.h);
    t[0] = less(far, zero) ? far : zero;
    t[1] = less(far, zero) ? zero : far;
    return 2;
  }
  DW c = dw_sub(dw3_square(f), r2);
  if (less(b.h, zero) && less(zero, c.h)) return 0; /* outside and moving away */
  DW disc = dw_sub(r2, dw3_square(dw3_along(f, b, direction)));
  if (less(disc.h, zero)) return 0;
  disc = dw_sub(disc, dw_times(disc, e));
  c = dw_sub(c, dw_times(c, e));
  DW s = less(zero, disc.h) ? dw_root(disc) : dw_from(zero);
  DW q = less(b.h, zero) ? dw_sub(b, s) : dw_add(b, s);
  REAL other = dw_is_zero(q) ? zero : dw_quotient(c, q);
  t[0] = less(q.h, other) ? q.h : other;
  t[1] = less(q.h, other) ? other : q.h;
  return 2;
}

/* The nearest root beyond t_min, or 0 where there is none. */
static inline REAL sphere_nearest(VEC origin, VEC direction, VEC center, REAL radius,
                                  int on_surface, REAL t_min) {
  REAL t[2];
  if (!sphere_roots(origin, direction, center, radius, on_surface, t)) return from_double(0);
  if (less(t_min, t[0])) return t[0];
  return less(t_min, t[1]) ? t[1] : from_double(0);
}

/* Does the ray surely lead away from the plane? In plain arithmetic way.n is wrong by less than
 * 6u(|way.x| + |way.y| + |way.z|), as no component of n exceeds 1, and d.n by less than 6u. */
static inline int plane_surely_behind(VEC way, VEC direction, VEC normal) {
  REAL rise = v_dot(way, normal), slope = v_dot(direction, normal);
  REAL sure_rise = mul(from_double(8 * REAL_UNIT), v_sum_of_magnitudes(way));
  REAL sure_slope = from_double(8 * REAL_UNIT);
  if (less(sure_slope, slope)) return less(rise, neg(sure_rise));
  return less(slope, neg(sure_slope)) && less(sure_rise, rise);
}

/* Plane: (P - o).n / (d.n) with P - o exact and both products in double-words: error below 1 ulp
 * (measured: 0.51) however flat the ray meets the plane, while d.n > 2^-50 |d||n|. */
static inline REAL plane_nearest(VEC origin, VEC direction, VEC point, VEC normal, REAL t_min) {
  REAL zero = from_double(0);
  if (plane_surely_behind(v_sub(point, origin), direction, normal)) return zero;
  DW slope = dw_dot(direction, normal);
  if (dw_is_zero(slope)) return zero;
  REAL t = dw_quotient(dw3_dot(dw3_difference(point, origin), normal), slope);
  return less(t_min, t) ? t : zero;
}

/* Refraction (specification 4.2): with index = over/under and g = over^2 - under^2 (1 - cosine^2)
 * in double-words, Delta = g / over^2 has the sign that the inputs give it down to |Delta| of
 * 2^-100; and sqrt(g) - under*cosine = (over^2 - under^2) / (sqrt(g) + under*cosine) does not
 * cancel for an index near 1. Each component of the direction errs by less than 5u
 * for an index from 0.4 to 2.5 (measured: 4u). */
static inline int refract(VEC wo, VEC normal, REAL cosine, INDEX index, VEC *out) {
  REAL zero = from_double(0);
  DW step = dw_sub(dw_two_product(index.over, index.over),
                   dw_two_product(index.under, index.under));
  DW across = dw_two_product(index.under, cosine);
  DW g = dw_add(step, dw_square(across));
  if (less(g.h, zero)) return 0;
  DW s = less(zero, g.h) ? dw_root(g) : dw_from(zero);
  DW sum = dw_add(s, across);
  REAL along_normal = dw_is_zero(sum) ? zero : dw_quotient(step, sum);
  VEC sum_of_two = v_make(fused(index.under, wo.x, mul(along_normal, normal.x)),
                          fused(index.under, wo.y, mul(along_normal, normal.y)),
                          fused(index.under, wo.z, mul(along_normal, normal.z)));
  *out = v_over(v_neg(sum_of_two), index.over);
  return 1;
}

/* max(0, r.wo)^eta of the specification's 3.2. For directions of equal length, 1 - r.wo/|r||wo| is
 * |r - wo|^2 / (|r|^2 + |wo|^2): near the highlight's middle that form feels neither the rounding
 * of the dot product nor that of the lengths. Relative error 8 (1 + |eta ln x|) u for
 * x = r.wo > 1/2 (measured: 7); below, that of the dot product, 2u eta/x. */
static inline REAL highlight(VEC mirrored, VEC wo, double eta) {
  REAL zero = from_double(0), one = from_double(1);
  REAL x = v_dot(mirrored, wo);
  if (!less(zero, x)) return zero;
  /* A normal as in the file (plane_normal=raw) makes vectors of other lengths. */
  REAL length2 = v_dot(mirrored, mirrored);
  int is_unit = less(magnitude(sub(length2, one)), from_double(256 * REAL_UNIT));
  if (!is_unit || less(x, from_double(0.5))) return power_of(x, eta);
  VEC apart = v_sub(mirrored, wo);
  REAL q = quo(v_dot(apart, apart), add(length2, v_dot(wo, wo)));
  REAL log_x = less(q, from_double(0.29)) ? log1p_of(neg(q)) : log_of(sub(one, q));
  return exponential_power(log_x, eta);
}
