/* A cheap test, in plain double, of which objects need an interval test at all.
 *
 * A ray of the set is within eo of `o` and ed of `d` in each component. Each step below carries a
 * bound of its error: the inputs' times the sensitivity, plus the roundings, each at most u = 2^-52
 * of its result in any rounding mode. An object is passed over only where every ray of the set
 * surely misses it, has it behind, or meets it beyond `before`.
 */

typedef struct SET_FN(filter) {
  double o[3], d[3], eo, ed, extent; /* extent: largest |o[k]| */
} FILTER;

#define FILTER_U 0x1p-52

/* As fmax, without its care for NaN. */
static inline double larger_of(double a, double b) { return a > b ? a : b; }

static double middle(IV a, double *error) {
  double lo = -b_to_double(a.nlo), hi = b_to_double(a.hi), m = 0.5 * lo + 0.5 * hi;
  double reach = larger_of(hi - m, m - lo);
  *error = larger_of(*error, reach + 2 * FILTER_U * (fabs(lo) + fabs(hi)));
  return m;
}

static FILTER filter_of(IV3 origin, IV3 direction) {
  FILTER f = {.eo = 0, .ed = 0};
  f.o[0] = middle(origin.x, &f.eo), f.d[0] = middle(direction.x, &f.ed);
  f.o[1] = middle(origin.y, &f.eo), f.d[1] = middle(direction.y, &f.ed);
  f.o[2] = middle(origin.z, &f.eo), f.d[2] = middle(direction.z, &f.ed);
  f.extent = larger_of(larger_of(fabs(f.o[0]), fabs(f.o[1])), fabs(f.o[2]));
  return f;
}

static int may_meet_sphere(const FILTER *q, const double *g, double before) {
  const double u = FILTER_U;
  double f[3], l[3], size = 0, center = 0, across = 0, b = 0, l2 = 0;
  for (int k = 0; k < 3; k++) {
    f[k] = q->o[k] - g[k];
    size = larger_of(size, fabs(f[k]));
    center = larger_of(center, fabs(g[k]));
    b -= f[k] * q->d[k];
  }
  double ef = q->eo + u * (q->extent + center);
  double eb = 3 * (size * q->ed + 2 * ef) + 12 * u * size;
  for (int k = 0; k < 3; k++) {
    l[k] = f[k] + b * q->d[k];
    across = larger_of(across, fabs(l[k]));
    l2 += l[k] * l[k];
  }
  double el = ef + (fabs(b) + eb) * q->ed + 2 * eb + 3 * u * (size + fabs(b));
  double r2 = g[3] * g[3];
  double reach = r2 - l2 + 3 * el * (2 * across + el) + 8 * u * (r2 + l2);
  if (reach < 0) return 0;
  double s = sqrt(reach) * (1 + 4 * u);
  return !(b - eb - s > before) && !(b + eb + s < 0);
}

static int may_meet_plane(const FILTER *q, const double *g, double before) {
  const double u = FILTER_U;
  double rise = 0, slope = 0, n = 0, way = 0;
  for (int k = 0; k < 3; k++) {
    double w = g[k] - q->o[k];
    rise += w * g[3 + k];
    slope += q->d[k] * g[3 + k];
    n = larger_of(n, fabs(g[3 + k]));
    way = larger_of(way, fabs(w) + u * fabs(g[k]));
  }
  double er = 3 * n * (q->eo + u * (q->extent + 5 * way)), es = 3 * n * (q->ed + 5 * u);
  if (fabs(slope) <= es) return 1;
  if (slope < 0) rise = -rise, slope = -slope;
  if (rise + er < 0) return 0;
  return !((rise - er) > before * (slope + es) * (1 + 4 * u));
}

static int may_meet(const WORLD *world, const FILTER *q, size_t i, double before) {
  const double *g = world->view->geometry + i * CT_GEOMETRY_COLUMNS;
  /* Errors of the arithmetic under test are not in the bounds above. */
  if (world->kappa > 0) return 1;
  return world->view->kind[i] == CT_SPHERE ? may_meet_sphere(q, g, before)
                                           : may_meet_plane(q, g, before);
}
