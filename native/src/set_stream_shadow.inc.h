/* What stands between the points of a surface and a light, with certainty or not: by the bounds of
 * set_stream_hit.inc.h, in plain double for planes as well. */

typedef struct SET_FN(lanes_shadow) {
  MASK sure, possible;
} SHADOW;

/* A root between `least` and [-limit_n, limit_h]. */
static inline void add_sphere_shadow(SHADOW *shadow, const MIDDLE *q, const SOLID *s, LANES least,
                                     LANES limit_n, LANES limit_h, MASK lanes) {
  MEETING m = meet(q, s, lanes);
  LANES zero = l_all(0), beyond = (limit_h + m.e) - m.b;
  /* Beyond the light: b - limit > 0 and above the root of disc. */
  MASK past = m_and(l_less(beyond, zero), l_less(m.disc_h + beyond * -beyond, zero));
  MASK live = m_but(m.live, past);
  if (!m_any(live)) return;
  ROOTS r = roots_of(&m);
  MASK near_out = m_or(l_at_most(r.near_h, least), l_less(r.near_n + limit_h, zero));
  MASK far_out = m_or(l_at_most(r.far_h, least), l_less(r.far_n + limit_h, zero));
  MASK near_in = m_and(l_less(r.near_n + least, zero), l_less(r.near_h + limit_n, zero));
  MASK far_in = m_and(l_less(r.far_n + least, zero), l_less(r.far_h + limit_n, zero));
  live = m_but(live, m_and(near_out, far_out));
  shadow->possible = m_or(shadow->possible, live);
  shadow->sure = m_or(shadow->sure, m_and(m_and(live, l_less(m.disc_n, zero)),
                                          m_or(near_in, far_in)));
}

/* In plain double: with N + |p| >= |p - o|, the errors of (p - o).n and d.n are at most
 * |n|(sqrt3 eo + 5u(N + |p|)) and |n|(sqrt3 ed + 5u). */
static inline void add_plane_shadow(SHADOW *shadow, const MIDDLE *q, const SOLID *s, LANES least,
                                    LANES limit_n, LANES limit_h, MASK lanes) {
  LANES zero = l_all(0), rise = zero, slope = zero;
  for (int k = 0; k < 3; k++) {
    if (!(s->g[3 + k] < 0) && !(s->g[3 + k] > 0)) continue;
    rise = rise + (s->g[k] - q->o[k]) * s->g[3 + k];
    slope = slope + q->d[k] * s->g[3 + k];
  }
  LANES er = (q->eo * 2.0 + (q->n + s->size) * (5 * LANE_U)) * s->slant;
  LANES es = (q->ed * 2.0 + 5 * LANE_U) * s->slant;
  MASK minus = l_less(slope, zero), is_steep;
  LANES steep_n = es - l_abs(slope), steep_h = es + l_abs(slope); /* of |slope| */
  LANES level_h = er - l_abs(rise);                                     /* of -|rise| */
  rise = l_blend(minus, -rise, rise);
  LANES rise_n = er - rise, rise_h = er + rise;
  is_steep = l_less(steep_n, zero);
  MASK out = m_or(m_and(is_steep, l_at_most(rise_h + least * steep_n, zero)),
               l_less(level_h + limit_h * steep_h, zero));
  MASK live = m_but(lanes, out);
  MASK in = m_and(l_less(rise_n + least * steep_h, zero),
                  l_less(rise_h + -limit_n * steep_n, zero));
  shadow->possible = m_or(shadow->possible, live);
  shadow->sure = m_or(shadow->sure, m_and(m_and(live, is_steep), in));
}

/* The solid that the rays leave, from a point P of it. A plane is not met again: the origin, moved
 * towards the light or to its side, and the light are on one side. From P + epsilon l, a sphere's
 * roots are exactly -epsilon and -epsilon - 2 (P - c).l, the second of which is `other`. */
static inline void add_own_shadow(SHADOW *shadow, VI other, LANES least, VI limit, MASK lanes) {
  LANES zero = l_all(0);
  MASK out = m_or(l_at_most(other.h, least), l_less(other.n + limit.h, zero));
  MASK in = m_and(l_less(other.n + least, zero), l_less(other.h + limit.n, zero));
  shadow->possible = m_or(shadow->possible, m_but(lanes, out));
  shadow->sure = m_or(shadow->sure, m_and(lanes, in));
}

static int is_apart(const SWORLD *world, const SOLID *solid) {
  for (size_t k = 0; k < world->n_solids; k++)
    if (world->solids[k].object == solid->object) return 1;
  return 0;
}

/* What of the tree stands there, but for the sphere that the rays leave, if that is in it. */
APART void add_tree_shadows(const SWORLD *world, const MIDDLE *q, const SOLID *own, LANES least,
                            VI limit, MASK lanes, SHADOW *shadow) {
  LANES error;
  MASK known = knows_tree(world, q, &error);
  shadow->possible = m_or(shadow->possible, m_but(lanes, known));
  size_t first;
  unsigned n;
  for (MASK left = m_and(lanes, known); m_any(left);) {
    ct_walk walk;
    MASK group = start_walk(world, q, error, left, &walk);
    left = m_but(left, group);
    float before = ct_walk_before(greatest_lane(limit.h, group));
    while (ct_walk_next(&walk, before, &first, &n))
      for (size_t k = first; k < first + n; k++) {
        size_t i = world->bvh->object[k];
        MASK open = m_but(group, shadow->sure);
        if (world->base->is_twin[i] || (own && own->object == i)) continue;
        SOLID s = sphere_in_tree(world, i);
        add_sphere_shadow(shadow, q, &s, least, limit.n, limit.h, open);
      }
  }
}

/* What of the solids of `may` and the tree may stand on the rays q before the light, whose distance
 * is `limit`. */
static inline SHADOW shadow_on(const SWORLD *world, uint64_t may, const MIDDLE *q, size_t light,
                               VI limit, const SOLID *own, VI other, MASK lanes) {
  const ct_frame *frame = world->base->frame;
  double far = frame->options->far;
  LANES least = l_all(frame->options->shadow_min);
  if (far > 0) limit = vi(l_greater(limit.n, l_all(-far)), l_lesser(limit.h, l_all(far)));
  SHADOW shadow = {m_none(), m_none()};
  int is_mitsuba = world->base->choice[CT_OFFSET] == CT_OFFSET_MITSUBA;
  if (world->bvh) {
    int is_own_there = !own->is_plane && !is_mitsuba && !is_apart(world, own);
    if (is_own_there) add_own_shadow(&shadow, other, least, limit, lanes);
    add_tree_shadows(world, q, is_own_there ? own : NULL, least, limit, lanes, &shadow);
  }
  for (size_t i = 0; i < world->n_solids; i++) {
    if (i < CULLED_SOLIDS && !(may >> i & 1)) continue;
    const SOLID *s = &world->solids[i];
    MASK left = m_but(lanes, shadow.sure);
    if (!m_any(left)) break;
    if (s->object == own->object && s->is_plane) continue;
    if (frame->n_lights_on && !is_mitsuba &&
        ct_light_is_on(frame, light, s->object)) {
      /* No blocker there but the far side of another sphere, left to the scalar kernel. */
      if (!s->is_plane && s->object != own->object)
        shadow.possible = m_or(shadow.possible, meet(q, s, left).live);
      continue;
    }
    if (s->object == own->object && !is_mitsuba)
      add_own_shadow(&shadow, other, least, limit, left);
    else if (s->is_plane)
      add_plane_shadow(&shadow, q, s, least, limit.n, limit.h, left);
    else
      add_sphere_shadow(&shadow, q, s, least, limit.n, limit.h, left);
  }
  return shadow;
}
