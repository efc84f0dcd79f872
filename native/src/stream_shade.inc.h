/* One pass over a vector: the light of the hits of one object, and the rays that they send on. */

/* Sends the lanes of `sent` on along `direction`. */
INLINE unsigned send(BRANCH *branch, size_t at, MASK sent, LANES weight, LANES part, int prunes,
                     VECS point, VECS direction) {
  unsigned lanes = m_bits(sent), n = (unsigned)__builtin_popcount(lanes);
  if (!lanes) return 0;
  branch->parcel[branch->n_parcels++] = (PARCEL){(uint16_t)at, (uint16_t)lanes};
  if (n < N_LANES) {
    weight = l_pack(sent, weight);
    if (prunes) part = l_pack(sent, part);
    point = vs_pack(sent, point);
    direction = vs_pack(sent, direction);
  }
  l_store(branch->weight + branch->rays.n, weight);
  if (prunes) l_store(branch->rays.slack + branch->rays.n, part / weight);
  vs_store(&branch->rays.origin, branch->rays.n, point);
  vs_store(&branch->rays.direction, branch->rays.n, direction);
  branch->rays.n += n;
  return n;
}

/* Puts terms of first hits where they are asked for. */
static void note_term(const STORE *store, int term, size_t at, MASK m, VECS c) {
  const COLUMNS *split = store->first.split + term;
  vs_store(split, at, vs_blend(m, c, vs_load(split, at)));
}

enum { TERM_BASE, TERM_DIFFUSE, TERM_SPECULAR, TERM_REFLECTION, TERM_REFRACTION, TERM_TOTAL };

/* Rays that the depth ends: what the reading `exhausted` puts in their place. */
static VECS end_rays(const STORE *store, VECS color, size_t at, MASK sent, MASK total,
                     LANES weight, int term, int is_first) {
  VECS c = vs_scale(weight, vs_all(store->stage->exhausted));
  if (is_first && store->wants_split) {
    note_term(store, term, at, m_but(sent, total), c);
    note_term(store, TERM_TOTAL, at, m_and(sent, total), c);
  }
  return vs_add_where(sent, color, c);
}

/* scatter_at (CT_TIR_REPLACE), and what becomes of the rays. */
INLINE void scatter_of(STORE *store, const SURFACE *s, const ROW *row, VECS point, VECS normal,
                       VECS direction, MASK hit, int is_first, int prunes, BRANCH *branches,
                       VECS *color) {
  unsigned effects = store->stage->world->effects;
  LANES zero = l_all(0), one = l_all(1);
  LANES cosine = vs_dot(normal, vs_neg(direction)), kr = l_all(s->kr);
  MASK inside = m_but(hit, l_less(zero, cosine)), total = m_none(), through = m_none();
  MASK back = s->has_kr ? hit : m_none();
  VECS facing = {l_negate_where(inside, normal.x), l_negate_where(inside, normal.y),
                 l_negate_where(inside, normal.z)};
  cosine = l_negate_where(inside, cosine);
  VECS refracted = direction;
  if (s->is_clear) {
    LANES ratio = l_blend(inside, l_all(s->ratio[1]), l_all(s->ratio[0]));
    LANES sine2 = (one - cosine) * (one + cosine), delta = one - (ratio * ratio) * sine2;
    total = m_and(hit, l_less(delta, zero));
    /* With wo the ray's direction turned round, whose signs cancel here exactly. */
    LANES along_normal = l_root(delta) - ratio * cosine;
    refracted = vs_sub(vs_scale(ratio, direction), vs_scale(along_normal, facing));
    if (s->has_kt) through = m_but(hit, total);
    if (effects & CT_TOTAL_REFLECTION) {
      kr = l_blend(total, one, kr);
      back = m_or(back, total);
    }
  }
  if (row->tree) {
    unsigned in = m_bits(inside), all = m_bits(total), lanes = m_bits(hit);
    for (unsigned kind = 0; kind < 4; kind++)
      note_decision(row, lanes & (kind & 1 ? in : ~in) & (kind & 2 ? all : ~all), kind);
  }
  VECS mirrored = vs_add(vs_scale(l_all(2) * cosine, facing), direction);
  if (is_first && store->wants_split)
    store->first.total[row->at / N_LANES] |= (uint16_t)m_bits(total);
  if (branches) {
    ct_pixel *pixel = store->pixel;
    LANES part = zero;
    if (prunes)
      part = prune_lanes(l_load(row->slack), row->most, kr, l_where(through, l_all(s->kt)), &back,
                          &through);
    pixel->n_reflected += send(branches, row->at, back, kr, part, prunes, point, mirrored);
    pixel->n_refracted +=
        send(branches + 1, row->at, through, l_all(s->kt), part, prunes, point, refracted);
  } else if (store->stage->ends_lit) {
    *color = end_rays(store, *color, row->at, back, total, kr, TERM_REFLECTION, is_first);
    *color = end_rays(store, *color, row->at, through, m_none(), l_all(s->kt), TERM_REFRACTION,
                      is_first);
  }
}

/* shade, without the secondary rays, for the lanes of `hit`, which all hit object i. */
INLINE void shade_of(STORE *store, size_t i, const ROW *row, VECS point, VECS direction, MASK hit,
                     int is_first, int prunes, BRANCH *branches, VECS *color) {
  const STAGE *stage = store->stage;
  SHAPE own;
  const SHAPE *shape = &own;
  if (stage->bvh)
    read_shape(stage->world, i, &own);
  else
    shape = stage->shape + i;
  const SURFACE *surface = stage->surface + i;
  VECS zero = vs_all(v_zero()), base = vs_all(surface->base), normal;
  if (shape->is_plane) {
    normal = vs_all(shape->normal);
  } else {
    VECS outward = vs_sub(point, vs_all(shape->at));
    normal = vs_over(outward, vs_length(outward));
  }
  VECS diffuse = zero, specular = zero, sum = base;
  if (stage->has_lights) {
    add_lights_of(store, surface, row, point, normal, direction, hit, &diffuse, &specular);
    sum = vs_add(vs_add(base, diffuse), specular);
  }
  if (is_first && store->wants_hit) {
    const COLUMNS *normals = &store->first.normal;
    vs_store(normals, row->at, vs_blend(hit, normal, vs_load(normals, row->at)));
  }
  if (is_first && store->wants_split) {
    note_term(store, TERM_BASE, row->at, hit, base);
    note_term(store, TERM_DIFFUSE, row->at, hit, diffuse);
    note_term(store, TERM_SPECULAR, row->at, hit, specular);
  }
  *color = vs_blend(hit, sum, *color);
  if (stage->has_scatter)
    scatter_of(store, surface, row, point, normal, direction, hit, is_first, prunes, branches,
               color);
}
