/* Which solid the rays of a vector hit, with certainty or not.
 *
 * Spheres are met in plain double with a bound of the error, as in set_filter.inc.h; the hit itself
 * is enclosed later (set_stream_point.inc.h). Planes are met by intervals, which keep the exact
 * zeros of a ray parallel to one.
 *
 * A ray of the set is o, d with |d| = 1; the middle of the set is p, e, each component within `eo`
 * of o's and `ed` <= 2^-8 of d's. N is at least |o| and |p|. For a sphere c, r let F >= N + |c|,
 * f = c - o, b = f.d, l = b d - f and disc = r^2 - |l|^2: the roots are b -+ sqrt(disc). Computed
 * from the middle, with the roundings of u = 2^-52 each,
 *   |f' - f| <= sqrt3 eo + uF
 *   |b' - b| <= |f' - f||e| + F sqrt3 ed + 3uF|e|             <= 1.75 eo + F(1.75 ed + 4.2u)
 *   |l' - l| <= |f' - f| + |b' - b||e| + F sqrt3 ed + 3.1uF + 2.1u|b' - b|
 *                                                             <= 3.5 eo + F(3.5 ed + 8.4u)
 * so E = 4 eo + F(4 ed + 16u) bounds both with a tenth to spare. As 2|l'| <= r + |l'|^2 / r,
 *   |disc' - disc| <= E(2|l'| + E) + 6u(r^2 + |l'|^2)  <=  E(r + |l'|^2/r + E) + 8u(r^2 + |l'|^2).
 * The 2^-500 in E is more than any underflow.
 */

typedef struct SET_FN(middle_ray) {
  LANES o[3], d[3];
  LANES error, slope; /* E = error + F * slope */
  LANES eo, ed, n;
} MIDDLE;

/* Fills what follows from p, e, eo and ed; says in which lanes the bounds above hold. */
static inline MASK complete_middle(MIDDLE *q) {
  LANES n = l_abs(q->o[0]) + l_abs(q->o[1]) + l_abs(q->o[2]);
  q->n = n + q->eo * 3.0;
  q->error = q->eo * 4.0 + 0x1p-500;
  q->slope = q->ed * 4.0 + 16 * LANE_U;
  /* Of a unit vector, |d1| + |d2| + |d3| is less than 2: what is no number is not. */
  LANES d = l_abs(q->d[0]) + l_abs(q->d[1]) + l_abs(q->d[2]);
  MASK known = m_and(l_at_most(q->ed, l_all(0x1p-8)), l_at_most(d, l_all(2)));
  return m_and(known, l_at_most(q->n, l_all(0x1p200)));
}

static inline MASK middle_of(const VI origin[3], const VI direction[3], MIDDLE *q) {
  q->eo = q->ed = l_all(0);
  for (int k = 0; k < 3; k++) {
    q->o[k] = vi_middle(origin[k]);
    q->d[k] = vi_middle(direction[k]);
    q->eo = l_greater(vi_reach(origin[k], q->o[k]), q->eo);
    q->ed = l_greater(vi_reach(direction[k], q->d[k]), q->ed);
  }
  return complete_middle(q);
}

typedef struct SET_FN(meeting) {
  LANES b, e;           /* b' and E */
  LANES disc_n, disc_h; /* bounds of -disc and disc */
  MASK live;           /* lanes that may meet it ahead */
  MASK inside;         /* lanes that surely start inside of it */
} MEETING;

/* Fills E and the bounds of disc, given F and |l'|^2. */
static inline void bound_meeting(MEETING *m, const MIDDLE *q, const SOLID *s, LANES size,
                                 LANES l2) {
  m->e = q->error + size * q->slope;
  LANES error = m->e * ((m->e + s->radius) + l2 * s->inverse_radius) +
            (l2 + s->square.hi) * (8 * LANE_U);
  LANES disc = s->square.hi - l2;
  m->disc_h = disc + error;
  m->disc_n = error - disc;
}

static inline LANES square_sum(const LANES a[3]) { return a[0] * a[0] + a[1] * a[1] + a[2] * a[2]; }

/* First with F = N + |c|, which most lanes need no better than; then with F = |f'| + 2 eo. Behind
 * is what has b < 0 and c = |f|^2 - r^2 = b^2 - disc > 0; from f itself, c is known the better. */
static inline MEETING meet(const MIDDLE *q, const SOLID *s, MASK lanes) {
  MEETING m;
  LANES f[3], l[3], zero = l_all(0);
  for (int k = 0; k < 3; k++) f[k] = s->g[k] - q->o[k];
  m.b = f[0] * q->d[0] + f[1] * q->d[1] + f[2] * q->d[2];
  for (int k = 0; k < 3; k++) l[k] = m.b * q->d[k] - f[k];
  LANES l2 = square_sum(l);
  bound_meeting(&m, q, s, q->n + s->size, l2);
  LANES ahead = m.b + m.e;
  MASK behind = m_and(l_less(ahead, zero), l_less(m.disc_h + ahead * -ahead, zero));
  m.live = m_but(m_but(lanes, l_less(m.disc_h, zero)), behind);
  m.inside = m_none();
  if (!m_any(m.live)) return m;

  LANES size = l_abs(f[0]) + l_abs(f[1]) + l_abs(f[2]) + q->eo * 2.0;
  bound_meeting(&m, q, s, size, l2);
  LANES f2 = square_sum(f), ef = q->eo * 2.0 + size * (2 * LANE_U);
  LANES error = ef * ((ef + s->radius) + f2 * s->inverse_radius) +
                (f2 + s->square.hi) * (8 * LANE_U);
  LANES c = f2 - s->square.hi;
  behind = m_and(l_less(m.b + m.e, zero), l_less(error, c));
  m.live = m_but(m_but(m.live, l_less(m.disc_h, zero)), behind);
  m.inside = l_less(c + error, zero);
  return m;
}

/* Bounds of both roots where there are any, and the middle of those of sqrt(disc). */
typedef struct SET_FN(roots) {
  LANES near_n, near_h, far_n, far_h, middle;
} ROOTS;

static inline ROOTS roots_of(const MEETING *m) {
  LANES zero = l_all(0), high = l_root(l_greater(m->disc_h, zero));
  LANES low = l_root(l_greater(-m->disc_n, zero)) * (1 - 4 * LANE_U);
  return (ROOTS){(high - m->b) + m->e, (m->b - low) + m->e, (m->e - m->b) - low,
                 (m->b + high) + m->e, (high + low) * 0.5};
}

/* ---- Nearest hit ---- */

typedef struct SET_FN(nearest) {
  IDS object;            /* index of the solid; with a tree, of the object; -1: none that is sure */
  LANES n, h;            /* bounds of its distance */
  LANES t, root; /* of a sphere: near the distance, and half the difference of the roots */
  LANES rival;           /* no other solid is hit before this */
} NEAREST;

static inline void offer(NEAREST *best, size_t object, MASK possible, MASK sure, LANES n, LANES h,
                         LANES t, LANES root) {
  MASK better = m_and(sure, l_less(h, best->h));
  LANES lo = l_greater(-n, l_all(0));
  LANES other = l_blend(better, -best->n, l_blend(possible, lo, l_all((double)INFINITY)));
  best->rival = l_lesser(other, best->rival);
  best->object = i_blend(better, i_all((LANE_ID)object), best->object);
  best->n = l_blend(better, n, best->n);
  best->h = l_blend(better, h, best->h);
  best->t = l_blend(better, t, best->t);
  best->root = l_blend(better, root, best->root);
}

static inline void offer_sphere(NEAREST *best, const MIDDLE *q, const SOLID *s, size_t index,
                                MASK lanes) {
  MEETING m = meet(q, s, lanes);
  if (!m_any(m.live)) return;
  LANES zero = l_all(0);
  ROOTS r = roots_of(&m);
  MASK is_past = m_or(m.inside, l_at_most(r.near_h, zero)); /* the near root is behind */
  LANES n = l_blend(is_past, r.far_n, r.near_n), h = l_blend(is_past, r.far_h, r.near_h);
  LANES t = l_blend(is_past, m.b + r.middle, m.b - r.middle);
  MASK possible = m_but(m.live, l_at_most(r.far_h, zero));
  /* The last condition is for the enclosure of the hit: set_stream_point.inc.h. */
  MASK sure = m_and(m_and(possible, l_less(m.disc_n, zero)),
                 m_and(l_less(n, zero), l_at_most(h + n, r.middle * 0x1p-11)));
  offer(best, index, possible, sure, n, h, t, r.middle);
}

#include "set_stream_tree.inc.h"

/* Exact where the plane's numbers and the ray's are. */
static inline VI slope_to(const SOLID *s, const VI d[3]) {
  VI sum = vi(l_all(0), l_all(0));
  for (int k = 0; k < 3; k++) {
    double n = s->g[3 + k];
    if (n > 0) sum = vi_add(sum, vi(d[k].n * n, d[k].h * n));
    if (n < 0) sum = vi_add(sum, vi(d[k].h * -n, d[k].n * -n));
  }
  return sum;
}

static inline void offer_plane(NEAREST *best, const VI o[3], const VI d[3], const SOLID *s,
                               size_t index, MASK lanes) {
  LANES zero = l_all(0);
  VI slope = slope_to(s, d), way[3];
  for (int k = 0; k < 3; k++) way[k] = vi(o[k].h - s->g[k], o[k].n + s->g[k]);
  VI rise = slope_to(s, way);
  MASK minus = l_less(slope.h, zero);
  slope = vi_flip(minus, slope);
  rise = vi_flip(minus, rise);
  MASK is_steep = l_less(slope.n, zero);
  MASK is_parallel = m_and(l_at_most(slope.n, zero), l_at_most(slope.h, zero));
  MASK is_behind = m_and(is_steep, l_at_most(rise.h, zero));
  MASK possible = m_but(m_but(lanes, is_parallel), is_behind);
  if (!m_any(possible)) return;
  LANES h = rise.h / -slope.n, n = rise.n / slope.h;
  MASK sure = m_and(m_and(possible, is_steep),
                    m_and(l_less(rise.n, zero), l_at_most(h, l_all(0x1p200))));
  offer(best, index, possible, sure, l_blend(sure, n, zero), h, zero, zero);
}

/* Among the solids of `may` and the tree. `bad`: lanes in which the answer is not certain. */
INLINE NEAREST nearest_of(const SWORLD *world, uint64_t may, const VI o[3], const VI d[3],
                          const MIDDLE *q, int is_primary, MASK lanes, MASK *bad) {
  LANES infinity = l_all((double)INFINITY);
  IDS none = i_all(-1);
  NEAREST best = {.object = none, .n = -infinity, .h = infinity, .t = infinity, .root = infinity,
                  .rival = infinity};
  MASK asked = lanes;
  for (size_t k = 0; k < world->n_solids; k++) {
    if (k < CULLED_SOLIDS && !(may >> k & 1)) continue;
    const SOLID *s = &world->solids[k];
    size_t i = world->bvh ? s->object : k;
    if (!s->is_plane)
      offer_sphere(&best, q, s, i, lanes);
    else if (!(is_primary && s->is_eye_on && world->base->choice[CT_OFFSET] != CT_OFFSET_MITSUBA))
      offer_plane(&best, o, d, s, i, lanes);
  }
  if (world->bvh) asked = offer_tree(world, q, lanes, &best);
  double far = world->base->frame->options->far;
  MASK is_hit = l_less(best.h, best.rival), is_miss = l_at_most(infinity, best.rival);
  is_miss = m_and(is_miss, i_equal(best.object, none));
  if (far > 0) {
    LANES limit = l_all(far);
    is_miss = m_or(is_miss, m_and(l_less(limit, -best.n), l_less(limit, best.rival)));
    is_hit = m_or(m_but(is_hit, l_less(limit, best.h)), is_miss);
    best.object = i_blend(is_miss, none, best.object);
  }
  *bad = m_but(lanes, m_and(asked, m_or(is_hit, is_miss)));
  return best;
}
