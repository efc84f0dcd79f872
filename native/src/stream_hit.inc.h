/* Rays side by side against one object after another: prim_plain.inc.h and world.inc.h's nearest,
 * operation by operation, with a mask in place of every branch. Work is left out where no lane
 * needs it, never where one does.
 */

/* Distances, and the lanes in which there is a hit beyond t_min. */
typedef struct FN(roots) {
  LANES t;
  MASK valid;
} FN(roots);
#define ROOTS FN(roots)

INLINE ROOTS roots_beyond(MASK wanted, LANES near, LANES far, LANES t_min) {
  LANES t = l_blend(l_less(t_min, near), near, far);
  return (ROOTS){t, m_and(wanted, l_less(t_min, t))};
}

/* sphere_nearest, where t_min is not below 0 and the origin is not on the sphere. */
INLINE ROOTS sphere_roots_at(VECS at, LANES r2, VECS origin, VECS direction, LANES t_min,
                             MASK wanted) {
  LANES zero = l_all(0);
  VECS f = vs_sub(origin, at);
  LANES b = -vs_dot(f, direction), c = vs_dot(f, f) - r2;
  MASK away = l_less(b, zero);
  wanted = m_but(wanted, m_and(away, l_less(zero, c)));
  if (!m_any(wanted)) return (ROOTS){zero, wanted};
  VECS l = vs_along(f, b, direction);
  LANES disc = r2 - vs_dot(l, l);
  wanted = m_but(wanted, l_less(disc, zero));
  if (!m_any(wanted)) return (ROOTS){zero, wanted};
  LANES s_root = l_root(disc), q = b + l_negate_where(away, s_root), other = c / q;
  /* Both roots are 0 where q is. */
  wanted = m_and(wanted, l_nonzero(q));
  return roots_beyond(wanted, l_lesser(q, other), l_greater(other, q), t_min);
}

INLINE ROOTS sphere_roots_of(const SHAPE *s, VECS origin, VECS direction, int on_surface,
                             LANES t_min, MASK wanted) {
  if (!on_surface)
    return sphere_roots_at(vs_all(s->at), l_all(s->r2), origin, direction, t_min, wanted);
  LANES zero = l_all(0), b = -vs_dot(vs_sub(origin, vs_all(s->at)), direction);
  LANES far = l_all(2) * b;
  MASK behind = l_less(far, zero);
  return roots_beyond(wanted, l_blend(behind, far, zero), l_blend(behind, zero, far), t_min);
}

/* plane_nearest; the quotient is above 0 only where its signs agree. */
INLINE ROOTS plane_root_of(const SHAPE *s, VECS origin, VECS direction, LANES t_min,
                                  MASK wanted) {
  VECS normal = vs_all(s->normal);
  LANES slope = vs_dot(direction, normal), rise = vs_dot(vs_sub(vs_all(s->at), origin), normal);
  wanted = m_but(wanted, l_signs_differ(slope, rise));
  wanted = m_and(wanted, l_nonzero(slope));
  if (!m_any(wanted)) return (ROOTS){l_all(0), wanted};
  LANES t = rise / slope;
  return (ROOTS){t, m_and(wanted, l_less(t_min, t))};
}

/* object_nearest, within the reading `far`. */
INLINE ROOTS roots_of(const STAGE *stage, const SHAPE *s, VECS origin, VECS direction,
                             int primary, LANES t_min, MASK wanted) {
  int on_surface = primary && s->eye_on;
  ROOTS roots;
  if (!s->is_plane)
    roots = sphere_roots_of(s, origin, direction, on_surface, t_min, wanted);
  else if (on_surface)
    roots = (ROOTS){l_all(0), m_none()};
  else
    roots = plane_root_of(s, origin, direction, t_min, wanted);
  if (stage->world->has_far)
    roots.valid = m_but(roots.valid, l_less(l_all(stage->world->far), roots.t));
  return roots;
}

typedef struct FN(hits) {
  LANES t; /* not a number: none */
  IDS object;
} FN(hits);
#define HITS FN(hits)

/* What n rays in columns, of which whole vectors can be read, hit among the objects whose bits are
 * set in `may`: object by object, as its numbers then stay in registers, and the branches taken for
 * it look alike. The distance is no number where nothing is hit. */
INLINE void nearest_in_columns(const STAGE *stage, const uint64_t *may, const COLUMNS *origin,
                               const COLUMNS *direction, size_t n, int primary, REAL *t,
                               LANE_ID *object) {
  LANES zero = l_all(0);
  for (size_t at = 0; at < n; at += N_LANES) {
    l_store(t + at, l_all((REAL)NAN));
    i_store(object + at, i_all(-1));
  }
  for (size_t word = 0; word < stage->n_words; word++)
    for (uint64_t left = may[word]; left; left &= left - 1) {
      size_t i = 64 * word + (unsigned)__builtin_ctzll(left);
      const SHAPE shape = stage->shape[i];
      IDS id = i_all((LANE_ID)i);
      for (size_t at = 0; at < n; at += N_LANES) {
        ROOTS roots = roots_of(stage, &shape, vs_load(origin, at), vs_load(direction, at), primary,
                               zero, m_first(n - at));
        LANES best = l_load(t + at);
        /* A tie stays with the first in the file. */
        MASK nearer = m_and(roots.valid, l_not_at_least(roots.t, best));
        if (!m_any(nearer)) continue;
        l_store(t + at, l_blend(nearer, roots.t, best));
        i_store(object + at, i_blend(nearer, id, i_load(object + at)));
      }
    }
}

/* blocks_own_light */
INLINE MASK blocking_own_light(const STAGE *stage, const SHAPE *s, VECS origin,
                                      VECS direction, LANES reach, LANES limit) {
  if (s->is_plane) return m_none();
  LANES b = -vs_dot(vs_sub(origin, vs_all(s->at)), direction), other = l_all(2) * b - reach;
  return m_and(l_less(l_all(stage->world->shadow_min), other), l_less(other, limit));
}

/* The lanes of `wanted` in which one object does, on which the lamp may lie. */
INLINE MASK blocking(const STAGE *stage, const SHAPE *s, int has_lamp, VECS origin, VECS direction,
                     LANES reach, LANES limit, MASK wanted) {
  if (has_lamp) return m_and(wanted, blocking_own_light(stage, s, origin, direction, reach, limit));
  LANES t_min = l_all(stage->world->shadow_min);
  ROOTS roots = roots_of(stage, s, origin, direction, 0, t_min, wanted);
  return m_and(roots.valid, l_less(roots.t, limit));
}

/* The lanes of `wanted` in which an object of `may` stands nearer than `limit` on the way to lamp
 * j, which is at `reach`. */
INLINE MASK blocked_of(const STAGE *stage, const uint64_t *may, size_t j, VECS origin,
                              VECS direction, LANES reach, LANES limit, MASK wanted) {
  MASK blocked = m_none();
  for (size_t word = 0; word < stage->n_words; word++)
    for (uint64_t left = may[word]; left; left &= left - 1) {
      size_t i = 64 * word + (unsigned)__builtin_ctzll(left);
      int has_lamp =
          stage->lamp[j].is_on_a_surface && ct_light_is_on(stage->world->frame, j, i);
      MASK here = blocking(stage, stage->shape + i, has_lamp, origin, direction, reach, limit, wanted);
      blocked = m_or(blocked, here);
      wanted = m_but(wanted, here);
      if (!m_any(wanted)) return blocked;
    }
  return blocked;
}
