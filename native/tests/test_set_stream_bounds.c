/* The bounds that the certified streams decide by hold what float128 computes, for rays from
 * anywhere in their sets: grazing, starting on a surface, from afar, from inside. */
#include "bound_f64.h"

#define ct_set_stream_set_f64 ct_set_stream_of_this_test
#include "lanes_generic.h"
#include "set_stream.inc.h"

#include "check.h"
#include "random.h"
#include "wide.h"

#if defined(__SIZEOF_FLOAT128__)
/* Called with the processor rounding upward, and out of line: a compiler may move arithmetic past a
 * change of the mode. */
#define UPWARD static __attribute__((noinline)) void

static ct_wide wide_abs(ct_wide x) { return x < 0 ? -x : x; }

static ct_wide wide_sqrt(ct_wide x) {
  ct_wide y = (ct_wide)sqrt((double)x);
  if (!(y > 0)) return 0;
  for (int i = 0; i < 3; i++) y = (y + x / y) / 2;
  return y;
}

/* A set of rays, all lanes alike, and one ray out of it; |d| = 1 within 2^-110. */
typedef struct ray_set {
  ct_wide o[3], d[3];
  VI origin[3], direction[3];
} ray_set;

/* The doubles around x, and sometimes more; sometimes x is one of the ends. */
static VI around(ct_wide x, double more) {
  double lo = (double)x, hi = lo;
  while ((ct_wide)lo > x) lo = nextafter(lo, -(double)INFINITY);
  while ((ct_wide)hi < x) hi = nextafter(hi, (double)INFINITY);
  int end = (int)(uniform() * 3);
  if (end != 0) lo -= more * uniform();
  if (end != 1) hi += more * uniform();
  return vi(l_all(-lo), l_all(hi));
}

static void set_rays(ray_set *r, double origin_error, double direction_error) {
  ct_wide length = 0;
  for (int k = 0; k < 3; k++) length += r->d[k] * r->d[k];
  length = wide_sqrt(length);
  for (int k = 0; k < 3; k++) {
    r->d[k] /= length;
    r->origin[k] = around(r->o[k], origin_error);
    r->direction[k] = around(r->d[k], direction_error);
  }
}

static double pick_error(void) { return uniform() < 0.5 ? 0 : exponential_in(1e-17, 1e-4); }

UPWARD complete_sphere(SOLID *s) {
  s->size = fabs(s->g[0]) + fabs(s->g[1]) + fabs(s->g[2]);
  s->slant = fabs(s->g[3]) + fabs(s->g[4]) + fabs(s->g[5]);
  s->square = i_square(i_from(s->radius));
  s->inverse = i_over_positive(i_from(1), i_from(s->radius));
  s->inverse_radius = s->inverse.hi;
}

/* A sphere, and a ray that it makes hard. */
static SOLID random_sphere(ray_set *r) {
  double scale = exponential_in(1e-6, 1e6), radius = scale * exponential_in(1e-3, 1e3);
  double away = uniform() < 0.5 ? 0 : scale * exponential_in(1, 1e6), d[3], across[3], e[3];
  SOLID s = {.radius = radius};
  for (int k = 0; k < 3; k++) s.g[k] = uniform_in(-1, 1) * away;
  s.g[3] = radius;
  random_direction(d);
  random_normal_to(d, across);
  random_direction(e);
  /* Passing at `miss` radii from the centre, starting `back` before the point nearest to it. */
  double miss = uniform() < 0.3 ? 1 + uniform_in(-1, 1) * exponential_in(1e-16, 1e-1)
                                : uniform_in(0, 1.5);
  double half = miss < 1 ? radius * sqrt(1 - miss * miss) : radius;
  double back = radius * uniform_in(-3, 20);
  if (uniform() < 0.4) /* on the surface, or nearly */
    back = half * (uniform() < 0.5 ? 1 : -1) + scale * uniform_in(-1e-5, 1e-5);
  for (int k = 0; k < 3; k++) {
    r->o[k] = (ct_wide)(s.g[k] + miss * radius * across[k] - back * d[k]);
    r->d[k] = d[k];
    if (uniform() < 0.1) r->o[k] = s.g[k], r->d[k] = e[k]; /* not quite unit: set_rays */
  }
  double size = fabs((double)r->o[0]) + fabs((double)r->o[1]) + fabs((double)r->o[2]);
  set_rays(r, pick_error() * (size + radius), pick_error());
  return s;
}

static int has(MASK m) { return (int)(m_bits(m) & 1); }
/* But for the roundings of float128 where numbers of this size were added up. */
static int nearly_between(LANES n, ct_wide x, LANES h, ct_wide size) {
  ct_wide slack = size * (ct_wide)0x1p-105;
  return -(ct_wide)n[0] - slack <= x && x <= (ct_wide)h[0] + slack;
}
static int between(LANES n, ct_wide x, LANES h) { return nearly_between(n, x, h, 0); }

typedef struct sphere_answer {
  MASK known;
  MEETING meeting;
  ROOTS roots;
  NEAREST best;
  HITS hit;
} sphere_answer;

UPWARD ask_sphere(const ray_set *r, const SOLID *s, sphere_answer *out) {
  MIDDLE q;
  MASK all = m_first(N_LANES);
  out->known = middle_of(r->origin, r->direction, &q);
  out->meeting = meet(&q, s, all);
  out->roots = roots_of(&out->meeting);
  out->best = (NEAREST){.object = i_all(-1), .n = l_all(-(double)INFINITY),
                        .h = l_all((double)INFINITY), .rival = l_all((double)INFINITY)};
  offer_sphere(&out->best, &q, s, 0, all);
  if (out->best.object[0] == 0)
    enclose_on_sphere(r->origin, r->direction, s, &out->best, &out->hit);
}

static void check_sphere(void) {
  ray_set r;
  SOLID s = random_sphere(&r);
  sphere_answer a = {.hit.solid = &s};
  fesetround(FE_UPWARD);
  complete_sphere(&s);
  ask_sphere(&r, &s, &a);
  fesetround(FE_TONEAREST);
  const MEETING m = a.meeting;
  const ROOTS roots = a.roots;
  const NEAREST best = a.best;
  const HITS hit = a.hit;
  if (!has(a.known)) return;

  ct_wide f[3], l[3], b = 0, l2 = 0, f2 = 0, square = (ct_wide)s.radius * s.radius;
  for (int k = 0; k < 3; k++) f[k] = (ct_wide)s.g[k] - r.o[k], b += f[k] * r.d[k];
  for (int k = 0; k < 3; k++) l[k] = b * r.d[k] - f[k], l2 += l[k] * l[k], f2 += f[k] * f[k];
  ct_wide disc = square - l2, root = disc > 0 ? wide_sqrt(disc) : 0;
  CHECK(wide_abs(b - (ct_wide)m.b[0]) <= (ct_wide)m.e[0]);
  CHECK(between(m.disc_n, disc, m.disc_h));
  if (!has(m.live)) {
    CHECK(disc < 0 || b + root < 0);
    return;
  }
  if (has(m.inside)) CHECK(f2 < square);
  if (disc < 0) return;
  CHECK(between(roots.near_n, b - root, roots.near_h));
  CHECK(between(roots.far_n, b + root, roots.far_h));

  /* The hit itself, where it is sure. */
  ct_wide t = b - root > 0 ? b - root : b + root;
  if (best.object[0] != 0) {
    CHECK(!(t > 0) || !((ct_wide)best.rival[0] > t));
    return;
  }
  CHECK(between(best.n, t, best.h));
  for (int k = 0; k < 3; k++) {
    CHECK(between(hit.across[k].n, r.o[k] + t * r.d[k] - s.g[k], hit.across[k].h));
    CHECK(between(hit.point[k].n, r.o[k] + t * r.d[k], hit.point[k].h));
  }
}

UPWARD ask_shadow(const ray_set *r, SOLID *s, double least, const VI *limit, MASK *known,
                  SHADOW *shadow) {
  MIDDLE q;
  MASK all = m_first(N_LANES);
  *shadow = (SHADOW){m_none(), m_none()};
  complete_sphere(s);
  *known = middle_of(r->origin, r->direction, &q);
  if (s->is_plane)
    add_plane_shadow(shadow, &q, s, l_all(least), limit->n, limit->h, all);
  else
    add_sphere_shadow(shadow, &q, s, l_all(least), limit->n, limit->h, all);
}

/* What blocks the way to a light at a distance known within `limit`. */
static void check_shadow(void) {
  ray_set r;
  SOLID s = random_sphere(&r);
  s.is_plane = uniform() < 0.5;
  ct_wide t[2] = {0, 0};
  int n = 0;
  if (s.is_plane) {
    double normal[3], scale = exponential_in(1e-3, 1e3);
    ct_wide rise = 0, slope = 0;
    random_direction(normal);
    for (int k = 0; k < 3; k++) {
      s.g[3 + k] = uniform() < 0.3 ? 0 : normal[k] * scale;
      if (uniform() < 0.3) s.g[k] = (double)r.o[k] + s.radius * uniform_in(-1e-9, 1e-9);
      rise += ((ct_wide)s.g[k] - r.o[k]) * s.g[3 + k];
      slope += r.d[k] * s.g[3 + k];
    }
    if (slope > 0 || slope < 0) t[n++] = rise / slope;
  } else {
    ct_wide b = 0, f2 = 0;
    for (int k = 0; k < 3; k++) {
      ct_wide f = (ct_wide)s.g[k] - r.o[k];
      b += f * r.d[k], f2 += f * f;
    }
    ct_wide disc = (ct_wide)s.radius * s.radius - f2 + b * b;
    if (disc >= 0) t[n++] = b - wide_sqrt(disc), t[n++] = b + wide_sqrt(disc);
  }
  double least = uniform() < 0.5 ? 0 : s.radius * exponential_in(1e-6, 1);
  ct_wide light = (ct_wide)s.radius * exponential_in(1e-3, 100);
  if (n && uniform() < 0.5) light = wide_abs(t[n - 1]) * (1 + uniform_in(-1e-12, 1e-12));
  if (n && t[0] > 0 && uniform() < 0.2) least = (double)t[0] * (1 + uniform_in(-1e-12, 1e-12));
  VI limit = around(light, (double)light * pick_error());
  if (!(-limit.n[0] > 0)) return;
  SHADOW shadow;
  MASK known;
  fesetround(FE_UPWARD);
  ask_shadow(&r, &s, least, &limit, &known, &shadow);
  fesetround(FE_TONEAREST);
  int is_blocked = 0;
  for (int i = 0; i < n; i++) is_blocked |= t[i] > least && t[i] < light;
  if (!has(known)) return;
  if (has(shadow.sure)) CHECK(is_blocked);
  if (!has(shadow.possible)) CHECK(!is_blocked);
}

/* An interval and a number in it: anywhere, or at an end. */
static VI random_interval(ct_wide *x) {
  double a = uniform() < 0.1 ? 0 : uniform_in(-1, 1) * exponential_in(1e-9, 1e9);
  VI i = around(a, uniform() < 0.2 ? 2 * fabs(a) : fabs(a) * pick_error());
  double part = uniform() < 0.5 ? nearbyint(uniform()) : uniform();
  *x = -(ct_wide)i.n[0] * (1 - (ct_wide)part) + (ct_wide)i.h[0] * part;
  return i;
}

typedef struct products {
  VI dot, product, square, by_positive, of_positives;
  LENGTH length;
} products;

UPWARD multiply(const VI a[3], const VI b[3], products *out) {
  VS3 s = vs3_of(a);
  VI positive = vi_floor_zero(b[0]);
  out->dot = vs3_dot(&s, b);
  out->product = vi_mul(a[0], b[0]);
  out->square = vi_square3(a);
  out->by_positive = vi_by_positive(positive, a[0]);
  out->of_positives = vi_of_positives(positive, vi_floor_zero(a[0]));
  out->length = length_of(out->square);
}

static void check_arithmetic(void) {
  ct_wide x[3], y[3], dot = 0, square = 0;
  VI a[3], b[3];
  for (int k = 0; k < 3; k++) {
    a[k] = random_interval(&x[k]);
    b[k] = random_interval(&y[k]);
    dot += x[k] * y[k];
    square += x[k] * x[k];
  }
  ct_wide size = wide_abs(x[0] * y[0]) + wide_abs(x[1] * y[1]) + wide_abs(x[2] * y[2]);
  products p;
  fesetround(FE_UPWARD);
  multiply(a, b, &p);
  fesetround(FE_TONEAREST);
  const LENGTH length = p.length;
  CHECK(nearly_between(p.dot.n, dot, p.dot.h, size));
  CHECK(between(p.product.n, x[0] * y[0], p.product.h));
  if (y[0] >= 0) CHECK(between(p.by_positive.n, x[0] * y[0], p.by_positive.h));
  if (y[0] >= 0 && x[0] >= 0) CHECK(between(p.of_positives.n, x[0] * y[0], p.of_positives.h));
  CHECK(nearly_between(p.square.n, square, p.square.h, square));
  if (!has(length.known)) return;
  ct_wide root = wide_sqrt(square);
  CHECK(between(length.length.n, root, length.length.h));
  CHECK(between(length.inverse.n, 1 / root, length.inverse.h));
  CHECK(wide_abs((ct_wide)length.y[0] * root - 1) <= (ct_wide)length.error[0]);
}

int main(int argc, char **argv) {
  int n = argc > 2 ? atoi(argv[2]) : 100000;
  if (argc > 3) random_state += (uint64_t)atoi(argv[3]) * UINT64_C(0x2545f4914f6cdd1d);
  for (int i = 0; i < n; i++) {
    check_sphere();
    check_shadow();
    check_arithmetic();
  }
  return 0;
}
#else
int main(void) { return 0; }
#endif
