/* Intersection, refraction and highlight in plain arithmetic, in forms that do not cancel where a
 * textbook's would. Directions are of length 1.
 *
 * Sphere: with f = o - c and b = -f.d, the squared distance of the line from the centre is that of
 * f + b*d (Hearn and Baker; Haines et al., Ray Tracing Gems 2019, chapter 7), so that a far, small
 * sphere keeps its digits; then q = b + sign(b)*sqrt(disc) and the roots are c/q and q, which never
 * subtract (Kahan). Measured in double, 99 % of t (tests/test_primitives.c): 2.5 ulp at any
 * distance to D/r = 1e8; 4e5 ulp where a ray grazes to 1e-12, 4e9 over a ground of r = 1e8; from
 * the surface itself without an offset 8 % of the decisions are wrong.
 *
 * Plane: (P - o).n / (d.n), which subtracts first, so that distance from the origin costs nothing;
 * 5 ulp, 6e5 where d.n = 1e-6.
 *
 * Refraction: some units of 2^-53 a component, 5e3 where |Delta| = 1e-7. Highlight: all of it is
 * the rounding of r.wo, about eta units.
 */

/* Writes the real roots in rising order and returns how many of them (0 or 2) there are; a tangent
 * ray has its root twice. on_surface: the origin lies on the sphere, so that one root is 0. */
static inline int sphere_roots(VEC origin, VEC direction, VEC center, REAL radius, int on_surface,
                               REAL t[2]) {
  REAL zero = from_double(0);
  VEC f = v_sub(origin, center);
  REAL b = neg(v_dot(f, direction));
  if (on_surface) {
    REAL far = mul(from_double(2), b);
    t[0] = less(far, zero) ? far : zero;
    t[1] = less(far, zero) ? zero : far;
    return 2;
  }
  REAL r2 = mul(radius, radius), c = sub(v_dot(f, f), r2);
  if (less(b, zero) && less(zero, c)) return 0; /* outside and moving away */
  VEC l = v_along(f, b, direction);
  REAL disc = sub(r2, v_dot(l, l));
  if (less(disc, zero)) return 0;
  REAL s = root(disc);
  REAL q = less(b, zero) ? sub(b, s) : add(b, s);
  REAL other = less(zero, magnitude(q)) ? quo(c, q) : zero;
  t[0] = less(q, other) ? q : other;
  t[1] = less(q, other) ? other : q;
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

/* The root, or 0 where the ray lies in the plane or runs parallel to it. */
static inline REAL plane_nearest(VEC origin, VEC direction, VEC point, VEC normal, REAL t_min) {
  REAL zero = from_double(0), slope = v_dot(direction, normal);
  if (!less(zero, magnitude(slope))) return zero;
  REAL t = quo(v_dot(v_sub(point, origin), normal), slope);
  return less(t_min, t) ? t : zero;
}

/* Refraction (specification 4.2): index is n seen from the side of the ray, normal and cosine
 * (normal.wo >= 0) too. Returns 0 where the light is totally reflected. */
static inline int refract(VEC wo, VEC normal, REAL cosine, INDEX index, VEC *out) {
  REAL one = from_double(1), zero = from_double(0);
  REAL ratio = quo(one, quo(index.over, index.under));
  REAL sine2 = mul(sub(one, cosine), add(one, cosine));
  REAL delta = sub(one, mul(mul(ratio, ratio), sine2));
  if (less(delta, zero)) return 0;
  REAL along_normal = sub(root(delta), mul(ratio, cosine));
  *out = v_sub(v_neg(v_scale(ratio, wo)), v_scale(along_normal, normal));
  return 1;
}

/* max(0, r.wo)^eta of the specification's 3.2. */
static inline REAL highlight(VEC mirrored, VEC wo, double eta) {
  REAL x = v_dot(mirrored, wo);
  return less(from_double(0), x) ? power_of(x, eta) : from_double(0);
}
