/* Enclosures of the hit points of one solid, and the light of the specification's 3.2 there. */

typedef struct SET_FN(hits) {
  const SOLID *solid;
  VI point[3];
  VI across[3]; /* normal as in the file: from the centre of a sphere, not of length 1 */
  VS3 across_signed, direction_signed; /* the former of spheres alone */
  VI inverse; /* of the length of `across` */
  VI cosine;  /* normal.wo */
} HITS;

/* With t near a root of g(t) = |o + t d - c|^2 - r^2 = (t - t1)(t - t2), the roots are
 * t1 = t + g(t) / (t2 - t) and t2 = t - g(t) / (t - t1): within |g(t) / D| of t. Here |D| is within
 * 2^-10 of itself of 2 root, as it is 2 sqrt(disc) but for |t - t1| or |t - t2|; with the bounds
 * -n and h of the hit, root is within (h + n)/2 of sqrt(disc) and t within h + n of the hit, and
 * set_stream_hit.inc.h asks that h + n <= 2^-11 root. */
static inline void enclose_on_sphere(const VI o[3], const VI d[3], const SOLID *s,
                                     const NEAREST *hit, HITS *out) {
  LANES t = l_greater(hit->t, l_all(0));
  VI l[3];
  for (int k = 0; k < 3; k++)
    l[k] = vi((o[k].n + s->g[k]) + t * d[k].n, (o[k].h - s->g[k]) + t * d[k].h);
  VI g = vi_add(vi_square3(l), vi(l_all(s->square.hi), l_all(s->square.nlo)));
  LANES reach = l_greater(g.n, g.h) * (0.5 / hit->root) * (1 + 0x1p-9);
  for (int k = 0; k < 3; k++) {
    LANES more = reach * l_greater(d[k].n, d[k].h);
    out->across[k] = vi(l[k].n + more, l[k].h + more);
    out->point[k] = vi(out->across[k].n - s->g[k], out->across[k].h + s->g[k]);
  }
}

static inline void enclose_on_plane(const VI o[3], const VI d[3], const SOLID *s,
                                    const NEAREST *hit, HITS *out) {
  LANES t = l_greater((hit->h - hit->n) * 0.5, l_all(0));
  LANES reach = l_greater(hit->h - t, hit->n + t);
  for (int k = 0; k < 3; k++) {
    LANES more = reach * l_greater(d[k].n, d[k].h);
    double n = s->g[3 + k];
    out->across[k] = vi(l_all(-n), l_all(n));
    /* Where the plane is one of constant x, y or z, the hit is on it exactly. */
    if (fabs(n) < s->slant)
      out->point[k] = vi((o[k].n + t * d[k].n) + more, (o[k].h + t * d[k].h) + more);
    else
      out->point[k] = vi(l_all(-s->g[k]), l_all(s->g[k]));
  }
}

/* across.a */
static inline VI across_along(const HITS *hit, const VI a[3]) {
  return hit->solid->is_plane ? slope_to(hit->solid, a) : vs3_dot(&hit->across_signed, a);
}

static inline void enclose_hits(const VI o[3], const VI d[3], const VS3 *d_signed,
                                const SOLID *solid, const NEAREST *hit, HITS *out) {
  out->solid = solid;
  if (solid->is_plane)
    enclose_on_plane(o, d, solid, hit, out);
  else
    enclose_on_sphere(o, d, solid, hit, out);
  out->direction_signed = *d_signed;
  if (!solid->is_plane) out->across_signed = vs3_of(out->across);
  out->inverse = vi_from(solid->inverse);
  VI along = across_along(out, d);
  out->cosine = vi_by_positive(out->inverse, vi(along.h, along.n));
}

/* ---- Where rays start ---- */

/* Mitsuba's step along the normal, times 1/|across|. */
static inline VI mitsuba_step(const HITS *hit) {
  LANES far = l_all(0), near = far;
  for (int k = 0; k < 3; k++) {
    far = l_greater(l_greater(hit->point[k].n, hit->point[k].h), far);
    near = l_greater(-l_lesser(hit->point[k].n, hit->point[k].h), near);
  }
  VI step = vi((-1.0 - near) * SET_MITSUBA_RAY, (far + 1.0) * SET_MITSUBA_RAY);
  return vi_of_positives(step, hit->inverse);
}

/* Point + step * across, the other way in the lanes `minus`. */
static inline void step_aside(const HITS *hit, VI step, MASK minus, VI out[3]) {
  for (int k = 0; k < 3; k++)
    out[k] = vi_add(hit->point[k], vi_by_positive(step, vi_flip(minus, hit->across[k])));
}

/* ---- Lights ---- */

/* The middle of the rays from `origin`, or epsilon beyond it, to a light `way` off. */
static inline MASK middle_to_light(const double *light, const VI way[3], const LENGTH *length,
                                double epsilon, MIDDLE *q) {
  LANES reach = l_all(0), size = l_all(epsilon);
  for (int k = 0; k < 3; k++) {
    LANES w = vi_middle(way[k]);
    reach = l_greater(vi_reach(way[k], w), reach);
    q->d[k] = w * length->y;
    q->o[k] = (light[k] - w) + q->d[k] * epsilon;
    size = size + l_abs(q->o[k]);
  }
  /* y w is within (reach) y + |y |w| - 1| of the unit direction, and one rounding. */
  q->ed = reach * length->y + (length->error + 4 * LANE_U);
  q->eo = (reach + q->ed * epsilon) + size * (4 * LANE_U);
  return complete_middle(q);
}

APART void add_light(const SWORLD *world, SIGHT *sight, const HITS *hit, size_t j, MASK lanes,
                     VI sum[3], MASK *bad) {
  const WORLD *base = world->base;
  size_t object = hit->solid->object;
  const double *m = base->view->material + object * CT_MATERIAL_COLUMNS;
  const double *light = base->view->lights + j * CT_LIGHT_COLUMNS + 3;
  int is_diffuse = (base->effects & CT_DIFFUSE) && m[CT_KD] > 0;
  int is_specular = (base->effects & CT_SPECULAR) && m[CT_KS] > 0;
  LANES zero = l_all(0);
  VI way[3], shine = vi(zero, zero);
  for (int k = 0; k < 3; k++)
    way[k] = vi(hit->point[k].h - light[k], hit->point[k].n + light[k]);
  LENGTH length = length_of(vi_square3(way));
  *bad = m_or(*bad, m_but(lanes, length.known));
  VI across = across_along(hit, way);
  VI cosine = vi_by_positive(vi_of_positives(hit->inverse, length.inverse), across);
  MASK needed = m_none();
  if (is_diffuse) needed = l_less(zero, cosine.h);
  if (is_specular) {
    VI half = vi_mul(cosine, hit->cosine), back = vs3_dot(&hit->direction_signed, way);
    back = vi_by_positive(length.inverse, back);
    shine = vi_floor_zero(vi_add(vi_add(half, half), back));
    MASK shines = l_less(zero, shine.h);
    needed = m_or(needed, shines);
    if (m[CT_ETA] == floor(m[CT_ETA]))
      shine = vi_power(shine, m[CT_ETA]);
    else
      *bad = m_or(*bad, m_and(lanes, shines)); /* series are for the scalar kernel */
  }
  needed = m_but(m_and(needed, lanes), *bad);
  if (!m_any(needed)) return;

  VI c[3];
  cosine = vi_floor_zero(cosine);
  if (is_specular) shine = vi_times(l_all(m[CT_KS]), shine);
  IV3 own = diffuse_of(base, object);
  const IV diffuse[3] = {own.x, own.y, own.z};
  const IV color[3] = {base->light[j].x, base->light[j].y, base->light[j].z};
  for (int k = 0; k < 3; k++) {
    c[k] = vi(zero, zero);
    if (is_diffuse) c[k] = vi_of_positives(vi_from(diffuse[k]), cosine);
    if (is_specular) c[k] = vi_add(c[k], shine);
    c[k] = vi_of_positives(vi_from(color[k]), c[k]);
  }
  if (base->effects & CT_SHADOWS) {
    MIDDLE q;
    VI limit = length.length, other = vi_by_positive(length.inverse, across);
    double epsilon = base->epsilon.hi, light_min = base->frame->options->light_min;
    MASK known;
    if (base->choice[CT_OFFSET] == CT_OFFSET_MITSUBA) {
      MASK minus = l_less(across.h, zero);
      VI from[3];
      *bad = m_or(*bad, m_but(needed, m_or(l_less(across.n, zero), minus)));
      step_aside(hit, mitsuba_step(hit), minus, from);
      for (int k = 0; k < 3; k++) way[k] = vi(from[k].h - light[k], from[k].n + light[k]);
      length = length_of(vi_square3(way));
      VI part = vi_times(l_all(1 - SET_MITSUBA_SHADOW), length.length);
      limit = vi(length.length.n + light_min, length.length.h - light_min);
      limit = vi(l_greater(part.n, limit.n), l_lesser(part.h, limit.h));
      known = m_and(length.known, middle_to_light(light, way, &length, 0, &q));
    } else {
      limit = vi((limit.n + epsilon) + light_min, (limit.h - epsilon) - light_min);
      other = vi(other.h * 2.0 + epsilon, other.n * 2.0 - epsilon);
      known = middle_to_light(light, way, &length, epsilon, &q);
    }
    /* A light too near the hit is not shadowed. */
    MASK apart = m_but(needed, l_at_most(limit.h, zero));
    known = m_and(known, l_less(limit.n, zero));
    *bad = m_or(*bad, m_but(apart, known));
    SHADOW shadow = shadow_on(world, blockers_of(world, sight, j), &q, j, limit, hit->solid, other,
                              m_but(apart, *bad));
    MASK doubtful = m_but(shadow.possible, shadow.sure);
    LANES most = l_greater(c[0].h, l_greater(c[1].h, c[2].h));
    MASK negligible = l_at_most(most, l_all(SET_NEGLIGIBLE));
    *bad = m_or(*bad, m_but(doubtful, negligible));
    needed = m_but(needed, shadow.sure);
    for (int k = 0; k < 3; k++) c[k].n = l_blend(doubtful, zero, c[k].n);
  }
  for (int k = 0; k < 3; k++) {
    sum[k].n = sum[k].n + l_blend(needed, c[k].n, zero);
    sum[k].h = sum[k].h + l_blend(needed, c[k].h, zero);
  }
}
