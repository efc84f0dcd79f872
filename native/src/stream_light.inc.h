/* The light of the specification's 3.2 on hits of one object side by side: light.inc.h and
 * power.inc.h, operation by operation. */

/* ---- Powers ---- */

/* power_of, lane by lane. */
static LANES power_one_by_one(MASK wanted, LANES x, double eta, LANES power) {
  REAL from[N_LANES], to[N_LANES];
  l_store(from, x);
  l_store(to, power);
  for (unsigned left = m_bits(wanted); left; left &= left - 1) {
    int k = __builtin_ctz(left);
    to[k] = power_of(from[k], eta);
  }
  return l_load(to);
}

/* x^eta in the lanes of `wanted`, where x > 0. */
INLINE LANES power_of_lanes(const SURFACE *s, MASK wanted, LANES x) {
  LANES zero = l_all(0), power = l_all(1), square = x;
  if (!s->is_squared) return power_one_by_one(wanted, x, s->eta, zero);
  for (unsigned eta = (unsigned)s->eta;; square = square * square) {
    if (eta & 1) power = power * square;
    eta >>= 1;
    if (!eta) break;
  }
  power = l_lesser(l_all(REAL_CEILING), power);
  MASK rare = m_and(wanted, l_less(l_all((REAL)1.5), x));
  if (REAL_LEAST != 0) {
    /* Underflown: nothing, or the least number; eta ln x decides, here by bounds wide enough for
     * its rounding, between them by itself. */
    MASK under = m_but(wanted, l_less(zero, power));
    power = l_blend(m_and(under, l_less(l_all(s->least_above), x)), l_all((REAL)REAL_LEAST), power);
    under = m_but(under, l_less(l_all(s->least_above), x));
    rare = m_or(rare, m_but(under, l_less(x, l_all(s->nothing_below))));
  }
  if (m_any(rare)) return power_one_by_one(rare, x, s->eta, power);
  return power;
}

/* ---- Lights ---- */

/* is_shadowed */
INLINE MASK shadowed(STORE *store, size_t j, const ROW *row, VECS point, VECS to_light,
                     LANES distance, MASK wanted) {
  const STAGE *stage = store->stage;
  LANES epsilon = l_all(stage->world->epsilon), reach = distance - epsilon;
  LANES limit = reach - l_all(stage->world->light_min);
  wanted = m_and(wanted, l_less(l_all(0), limit)); /* else a light within epsilon of the hit */
  unsigned sent = m_bits(wanted);
  if (!sent) return wanted;
  count_shadow_rays(store, row, sent);
  VECS origin = vs_along(point, epsilon, to_light);
  return blocked_in_sight(stage, row->sight, j, origin, to_light, reach, limit, wanted);
}

/* add_lights */
INLINE void add_lights_of(STORE *store, const SURFACE *s, const ROW *row, VECS point, VECS n,
                          VECS direction, MASK hit, VECS *diffuse, VECS *specular) {
  const STAGE *stage = store->stage;
  if (!s->is_diffuse && !s->is_specular) return;
  LANES zero = l_all(0);
  for (size_t j = 0; j < stage->n_lamps; j++) {
    const LAMP *lamp = stage->lamp + j;
    VECS way = vs_sub(vs_all(lamp->at), point);
    LANES distance = vs_length(way);
    MASK active = m_and(hit, l_less(zero, distance));
    VECS l = vs_over(way, distance);
    LANES cosine = vs_dot(n, l), shine = zero;
    MASK lit = m_none(), shiny = m_none();
    if (s->is_diffuse) lit = m_and(active, l_less(zero, cosine));
    if (s->is_specular) {
      /* Of r.wo; but for the sign of a zero, which no comparison sees. */
      LANES x = -vs_dot(vs_sub(vs_scale(l_all(2) * cosine, n), l), direction);
      shiny = m_and(active, l_less(zero, x));
      if (m_any(shiny)) {
        shine = power_of_lanes(s, shiny, x);
        shiny = m_and(shiny, l_less(zero, shine));
      }
    }
    MASK wanted = m_or(lit, shiny);
    if (!m_any(wanted)) continue;
    if (stage->world->effects & CT_SHADOWS) {
      MASK dark = shadowed(store, j, row, point, l, distance, wanted);
      note_decision(row, m_bits(dark), j + 1);
      lit = m_but(lit, dark);
      shiny = m_but(shiny, dark);
    }
    VECS c = vs_all(lamp->color), light = vs_scale(cosine, vs_all(s->diffuse));
    *diffuse = vs_add_where(lit, *diffuse, vs_mul(light, c));
    if (m_any(shiny))
      *specular = vs_add_where(shiny, *specular, vs_scale(l_all(s->ks) * shine, c));
  }
}
