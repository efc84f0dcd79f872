/* Which solid the rays of a vector hit, and what stands before a light, with certainty or not.
 *
 * Spheres are met in plain double with a bound of the error, as in set_filter.inc.h; the hit itself
 * is enclosed later (set_stream_point.inc.h). Planes are met by intervals, which keep the exact
 * zeros of a ray parallel to one.
 *
 * A ray of the set is o, d with |d| = 1; the middle of the set is p, e, each component within `eo` of
 * o's and `ed` <= 2^-8 of d's. N is at least |o| and |p|. For a sphere c, r let F >= N + |c|, and let
 * f = c - o, b = f.d, l = b d - f, disc = r^2 - |l|^2, whose roots are b -+ sqrt(disc). Computed from
 * the middle, with the roundings of u = 2^-52 each,
 *   |f' - f| <= sqrt3 eo + uF
 *   |b' - b| <= |f' - f||e| + F sqrt3 ed + 3uF|e|             <= 1.75 eo + F(1.75 ed + 4.2u)
 *   |l' - l| <= |f' - f| + |b' - b||e| + F sqrt3 ed + 3.1uF + 2.1u|b' - b|
 *                                                             <= 3.5 eo + F(3.5 ed + 8.3u)
 * so E = 4 eo + F(4 ed + 16u) bounds both with a tenth to spare. As 2|l'| <= r + |l'|^2 / r,
 *   |disc' - disc| <= E(2|l'| + E) + 6u(r^2 + |l'|^2)  <=  E(r + |l'|^2 / r + E) + 8u(r^2 + |l'|^2).
 * The 2^-500 in E is more than any underflow.
 */

typedef struct SET_FN(middle_ray) {
  V o[3], d[3];
  V error, slope; /* E = error + F * slope */
  V eo, ed, n;
} MIDDLE;

/* Fills what follows from p, e, eo and ed; says in which lanes the bounds above hold. */
static inline M complete_middle(MIDDLE *q) {
  V n = v_magnitude(q->o[0]) + v_magnitude(q->o[1]) + v_magnitude(q->o[2]);
  q->n = n + q->eo * 3.0;
  q->error = q->eo * 4.0 + 0x1p-500;
  q->slope = q->ed * 4.0 + 16 * LANE_U;
  return m_and(v_at_most(q->ed, v_from(0x1p-8)), v_at_most(q->n, v_from(0x1p200)));
}

static inline M middle_of(const VI origin[3], const VI direction[3], MIDDLE *q) {
  q->eo = q->ed = v_from(0);
  for (int k = 0; k < 3; k++) {
    q->o[k] = vi_middle(origin[k]);
    q->d[k] = vi_middle(direction[k]);
    q->eo = v_max(vi_reach(origin[k], q->o[k]), q->eo);
    q->ed = v_max(vi_reach(direction[k], q->d[k]), q->ed);
  }
  return complete_middle(q);
}

typedef struct SET_FN(meeting) {
  V b, e;           /* b' and E */
  V disc_n, disc_h; /* bounds of -disc and disc */
  M live;           /* lanes that may meet it ahead */
  M inside;         /* lanes that surely start inside of it */
} MEETING;

/* Fills E and the bounds of disc, given F and |l'|^2. */
static inline void bound_meeting(MEETING *m, const MIDDLE *q, const SOLID *s, V size, V l2) {
  m->e = q->error + size * q->slope;
  V error = m->e * ((m->e + s->radius) + l2 * s->inverse_radius) +
            (l2 + s->square.hi) * (8 * LANE_U);
  V disc = s->square.hi - l2;
  m->disc_h = disc + error;
  m->disc_n = error - disc;
}

static inline V square_sum(const V a[3]) { return a[0] * a[0] + a[1] * a[1] + a[2] * a[2]; }

/* First with F = N + |c|, which most lanes need no better than; then with F = |f'| + 2 eo. Behind is
 * what has b < 0 and c = |f|^2 - r^2 = b^2 - disc > 0; from f itself, c is known the better. */
static inline MEETING meet(const MIDDLE *q, const SOLID *s, M lanes) {
  MEETING m;
  V f[3], l[3], zero = v_from(0);
  for (int k = 0; k < 3; k++) f[k] = s->g[k] - q->o[k];
  m.b = f[0] * q->d[0] + f[1] * q->d[1] + f[2] * q->d[2];
  for (int k = 0; k < 3; k++) l[k] = m.b * q->d[k] - f[k];
  V l2 = square_sum(l);
  bound_meeting(&m, q, s, q->n + s->size, l2);
  V ahead = m.b + m.e;
  M behind = m_and(v_less(ahead, zero), v_less(m.disc_h + ahead * -ahead, zero));
  m.live = m_without(m_without(lanes, v_less(m.disc_h, zero)), behind);
  m.inside = m_from_bits(0);
  if (!m_bits(m.live)) return m;

  V size = v_magnitude(f[0]) + v_magnitude(f[1]) + v_magnitude(f[2]) + q->eo * 2.0;
  bound_meeting(&m, q, s, size, l2);
  V f2 = square_sum(f), ef = q->eo * 2.0 + size * (2 * LANE_U);
  V error = ef * ((ef + s->radius) + f2 * s->inverse_radius) + (f2 + s->square.hi) * (8 * LANE_U);
  V c = f2 - s->square.hi;
  behind = m_and(v_less(m.b + m.e, zero), v_less(error, c));
  m.live = m_without(m_without(m.live, v_less(m.disc_h, zero)), behind);
  m.inside = v_less(c + error, zero);
  return m;
}

/* Bounds of both roots where there are any; the middle of the root of disc, within root_h - root_l. */
typedef struct SET_FN(roots) {
  V near_n, near_h, far_n, far_h, middle;
} ROOTS;

static inline ROOTS roots_of(const MEETING *m) {
  V zero = v_from(0), high = v_sqrt(v_max(m->disc_h, zero));
  V low = v_sqrt(v_max(-m->disc_n, zero)) * (1 - 4 * LANE_U);
  return (ROOTS){(high - m->b) + m->e, (m->b - low) + m->e, (m->e - m->b) - low,
                 (m->b + high) + m->e, (high + low) * 0.5};
}

/* ---- Nearest hit ---- */

typedef struct SET_FN(nearest) {
  V object;          /* index of the solid, -1: none that is sure */
  V n, h;            /* bounds of its distance */
  V t, root;         /* of a sphere: near the distance, and half the difference of the roots, negative
                        at the far one */
  V rival;           /* no other solid is hit before this */
} NEAREST;

static inline void offer(NEAREST *best, size_t object, M possible, M sure, V n, V h, V t, V root) {
  M better = m_and(sure, v_less(h, best->h));
  V lo = v_max(-n, v_from(0));
  V other = v_select(better, -best->n, v_select(possible, lo, v_from((double)INFINITY)));
  best->rival = v_min(other, best->rival);
  best->object = v_select(better, v_from((double)object), best->object);
  best->n = v_select(better, n, best->n);
  best->h = v_select(better, h, best->h);
  best->t = v_select(better, t, best->t);
  best->root = v_select(better, root, best->root);
}

static inline void offer_sphere(NEAREST *best, const MIDDLE *q, const SOLID *s, size_t index,
                                M lanes) {
  MEETING m = meet(q, s, lanes);
  if (!m_bits(m.live)) return;
  V zero = v_from(0);
  ROOTS r = roots_of(&m);
  M is_past = m_or(m.inside, v_at_most(r.near_h, zero)); /* the near root is behind */
  V n = v_select(is_past, r.far_n, r.near_n), h = v_select(is_past, r.far_h, r.near_h);
  V t = v_select(is_past, m.b + r.middle, m.b - r.middle);
  M possible = m_without(m.live, v_at_most(r.far_h, zero));
  /* The last condition is for the enclosure of the hit: set_stream_point.inc.h. */
  M sure = m_and(m_and(possible, v_less(m.disc_n, zero)),
                 m_and(v_less(n, zero), v_at_most(h + n, r.middle * 0x1p-11)));
  offer(best, index, possible, sure, n, h, t, v_select(is_past, -r.middle, r.middle));
}

/* Exact where the plane's numbers and the ray's are. */
static inline VI slope_to(const SOLID *s, const VI d[3]) {
  VI sum = vi(v_from(0), v_from(0));
  for (int k = 0; k < 3; k++) {
    double n = s->g[3 + k];
    if (n > 0) sum = vi_add(sum, vi(d[k].n * n, d[k].h * n));
    if (n < 0) sum = vi_add(sum, vi(d[k].h * -n, d[k].n * -n));
  }
  return sum;
}

static inline void offer_plane(NEAREST *best, const VI o[3], const VI d[3], const SOLID *s,
                               size_t index, M lanes) {
  V zero = v_from(0);
  VI slope = slope_to(s, d), way[3];
  for (int k = 0; k < 3; k++) way[k] = vi(o[k].h - s->g[k], o[k].n + s->g[k]);
  VI rise = slope_to(s, way);
  M minus = v_less(slope.h, zero);
  slope = vi_flip(minus, slope);
  rise = vi_flip(minus, rise);
  M is_steep = v_less(slope.n, zero);
  M is_parallel = m_and(v_at_most(slope.n, zero), v_at_most(slope.h, zero));
  M is_behind = m_and(is_steep, v_at_most(rise.h, zero));
  M possible = m_without(m_without(lanes, is_parallel), is_behind);
  if (!m_bits(possible)) return;
  V h = rise.h / -slope.n, n = rise.n / slope.h;
  M sure = m_and(m_and(possible, is_steep), m_and(v_less(rise.n, zero), v_at_most(h, v_from(0x1p200))));
  offer(best, index, possible, sure, v_select(sure, n, zero), h, zero, zero);
}

/* `bad`: lanes in which the answer is not certain. */
static inline NEAREST nearest_of(const SWORLD *world, const VI o[3], const VI d[3],
                                 const MIDDLE *q, int is_primary, M lanes, M *bad) {
  V infinity = v_from((double)INFINITY), none = v_from(-1);
  NEAREST best = {.object = none, .n = -infinity, .h = infinity, .t = infinity, .root = infinity,
                  .rival = infinity};
  for (size_t i = 0; i < world->n_solids; i++) {
    const SOLID *s = &world->solids[i];
    if (!s->is_plane)
      offer_sphere(&best, q, s, i, lanes);
    else if (!(is_primary && s->is_eye_on && world->base->choice[CT_OFFSET] != CT_OFFSET_MITSUBA))
      offer_plane(&best, o, d, s, i, lanes);
  }
  double far = world->base->frame->options->far;
  M is_hit = v_less(best.h, best.rival), is_miss = v_equal(best.rival, infinity);
  is_miss = m_and(is_miss, v_equal(best.object, none));
  if (far > 0) {
    V limit = v_from(far);
    is_miss = m_or(is_miss, m_and(v_less(limit, -best.n), v_less(limit, best.rival)));
    is_hit = m_or(m_without(is_hit, v_less(limit, best.h)), is_miss);
    best.object = v_select(is_miss, none, best.object);
  }
  *bad = m_without(lanes, m_or(is_hit, is_miss));
  return best;
}

/* ---- Shadows ---- */

typedef struct SET_FN(lanes_shadow) {
  M sure, possible;
} SHADOW;

/* A root between `least` and [-limit_n, limit_h]. */
static inline void add_sphere_shadow(SHADOW *shadow, const MIDDLE *q, const SOLID *s, V least,
                                     V limit_n, V limit_h, M lanes) {
  MEETING m = meet(q, s, lanes);
  V zero = v_from(0), beyond = (limit_h + m.e) - m.b;
  /* Beyond the light: b - limit > 0 and above the root of disc. */
  M past = m_and(v_less(beyond, zero), v_less(m.disc_h + beyond * -beyond, zero));
  M live = m_without(m.live, past);
  if (!m_bits(live)) return;
  ROOTS r = roots_of(&m);
  M near_out = m_or(v_at_most(r.near_h, least), v_less(r.near_n + limit_h, zero));
  M far_out = m_or(v_at_most(r.far_h, least), v_less(r.far_n + limit_h, zero));
  M near_in = m_and(v_less(r.near_n + least, zero), v_less(r.near_h + limit_n, zero));
  M far_in = m_and(v_less(r.far_n + least, zero), v_less(r.far_h + limit_n, zero));
  live = m_without(live, m_and(near_out, far_out));
  shadow->possible = m_or(shadow->possible, live);
  shadow->sure = m_or(shadow->sure, m_and(m_and(live, v_less(m.disc_n, zero)),
                                          m_or(near_in, far_in)));
}

/* In plain double: with N + |p| >= |p - o|, the errors of (p - o).n and d.n are at most
 * |n|(sqrt3 eo + 5u(N + |p|)) and |n|(sqrt3 ed + 5u). */
static inline void add_plane_shadow(SHADOW *shadow, const MIDDLE *q, const SOLID *s, V least,
                                    V limit_n, V limit_h, M lanes) {
  V zero = v_from(0), rise = zero, slope = zero;
  for (int k = 0; k < 3; k++) {
    if (!(s->g[3 + k] < 0) && !(s->g[3 + k] > 0)) continue;
    rise = rise + (s->g[k] - q->o[k]) * s->g[3 + k];
    slope = slope + q->d[k] * s->g[3 + k];
  }
  V er = (q->eo * 2.0 + (q->n + s->size) * (5 * LANE_U)) * s->slant;
  V es = (q->ed * 2.0 + 5 * LANE_U) * s->slant;
  M minus = v_less(slope, zero), is_steep;
  V steep_n = es - v_magnitude(slope), steep_h = es + v_magnitude(slope); /* of |slope| */
  V level_h = er - v_magnitude(rise);                                     /* of -|rise| */
  rise = v_select(minus, -rise, rise);
  V rise_n = er - rise, rise_h = er + rise;
  is_steep = v_less(steep_n, zero);
  M out = m_or(m_and(is_steep, v_at_most(rise_h + least * steep_n, zero)),
               v_less(level_h + limit_h * steep_h, zero));
  M live = m_without(lanes, out);
  M in = m_and(v_less(rise_n + least * steep_h, zero), v_less(rise_h + -limit_n * steep_n, zero));
  shadow->possible = m_or(shadow->possible, live);
  shadow->sure = m_or(shadow->sure, m_and(m_and(live, is_steep), in));
}

/* The solid that the rays leave, from a point P of it. A plane is not met again: the origin, moved
 * towards the light or to its side, and the light are on one side. From P + epsilon l, a sphere's
 * roots are exactly -epsilon and -epsilon - 2 (P - c).l, the second of which is `other`. */
static inline void add_own_shadow(SHADOW *shadow, VI other, V least, VI limit, M lanes) {
  V zero = v_from(0);
  M out = m_or(v_at_most(other.h, least), v_less(other.n + limit.h, zero));
  M in = m_and(v_less(other.n + least, zero), v_less(other.h + limit.n, zero));
  shadow->possible = m_or(shadow->possible, m_without(lanes, out));
  shadow->sure = m_or(shadow->sure, m_and(lanes, in));
}

/* What may stand on the rays q before the light, whose distance is `limit`. */
static inline SHADOW shadow_on(const SWORLD *world, const MIDDLE *q, size_t light, VI limit,
                               const SOLID *own, VI other, M lanes) {
  const ct_frame *frame = world->base->frame;
  double far = frame->options->far;
  V least = v_from(frame->options->shadow_min);
  if (far > 0) limit = vi(v_max(limit.n, v_from(-far)), v_min(limit.h, v_from(far)));
  SHADOW shadow = {m_from_bits(0), m_from_bits(0)};
  for (size_t i = 0; i < world->n_solids; i++) {
    const SOLID *s = &world->solids[i];
    M left = m_without(lanes, shadow.sure);
    if (!m_bits(left)) break;
    if (s == own && s->is_plane) continue;
    if (frame->n_lights_on && world->base->choice[CT_OFFSET] != CT_OFFSET_MITSUBA &&
        ct_light_is_on(frame, light, s->object)) {
      /* No blocker there but the far side of another sphere, left to the scalar kernel. */
      if (!s->is_plane && s != own) shadow.possible = m_or(shadow.possible, meet(q, s, left).live);
      continue;
    }
    if (s == own && world->base->choice[CT_OFFSET] != CT_OFFSET_MITSUBA)
      add_own_shadow(&shadow, other, least, limit, left);
    else if (s->is_plane)
      add_plane_shadow(&shadow, q, s, least, limit.n, limit.h, left);
    else
      add_sphere_shadow(&shadow, q, s, least, limit.n, limit.h, left);
  }
  return shadow;
}
