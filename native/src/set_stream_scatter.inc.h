/* Secondary rays of the hits of one solid (specification 4.1, 4.2). */

/* A part of a vector whose rays went on: where they are in the child stream, what they weigh. */
typedef struct SET_FN(record) {
  int vector, at;
  unsigned bits;
  double weight;
} RECORD;

typedef struct SET_FN(child) {
  STREAM rays;
  int n_records;
  RECORD records[CT_SET_STREAM]; /* at least a ray each */
  ct_medium entered[ROOM]; /* but for nesting=relative */
} CHILD;

static inline void append(CHILD *child, int vector, MASK lanes, double weight, const VI origin[3],
                          const VI direction[3], LANES slot) {
  STREAM *to = &child->rays;
  unsigned bits = m_bits(lanes);
  if (!bits) return;
  for (int k = 0; k < 3; k++) {
    l_store(to->origin[k] + to->n, l_pack(lanes, origin[k].n));
    l_store(to->origin[3 + k] + to->n, l_pack(lanes, origin[k].h));
    l_store(to->direction[k] + to->n, l_pack(lanes, direction[k].n));
    l_store(to->direction[3 + k] + to->n, l_pack(lanes, direction[k].h));
  }
  l_store(to->slot + to->n, l_pack(lanes, slot));
  child->records[child->n_records++] = (RECORD){vector, to->n, bits, weight};
  to->n += __builtin_popcount(bits);
}

static inline void start_beside(const SWORLD *world, const HITS *hit, MASK minus, const VI d[3],
                                VI origin[3]) {
  if (world->base->choice[CT_OFFSET] == CT_OFFSET_MITSUBA) {
    step_aside(hit, mitsuba_step(hit), minus, origin);
    return;
  }
  LANES epsilon = l_all(world->base->epsilon.hi);
  for (int k = 0; k < 3; k++) origin[k] = vi_add(hit->point[k], vi_times(epsilon, d[k]));
}

/* Index on the ray's side over that beyond, for each lane. Where the ray passes as if there were no
 * surface (nesting=interiors), the lane is bad. */
static inline VI ratio_at(const SWORLD *world, const HITS *hit, const STREAM *rays, int at,
                          MASK inside, MASK lanes, MASK *bad) {
  const ct_scene_view *view = world->base->view;
  double n = view->material[hit->solid->object * CT_MATERIAL_COLUMNS + CT_N];
  int nesting = world->base->choice[CT_NESTING];
  if (nesting == CT_NESTING_RELATIVE)
    return vi_select(inside, vi(l_all(-n), l_all(n)),
                     vi_from(i_over_positive(i_from(1), i_from(n))));
  double own[N_LANES], beyond[N_LANES];
  unsigned in = m_bits(inside), used = m_bits(lanes), passing = 0;
  for (int k = 0; k < N_LANES; k++) {
    own[k] = beyond[k] = 1;
    if (!(used >> k & 1)) continue;
    const ct_medium *medium = rays->medium[at + k];
    ct_medium entered = ct_medium_crossed(nesting, medium, hit->solid->object, in >> k & 1);
    if (ct_medium_passes(view, nesting, &entered)) passing |= 1u << k;
    own[k] = ct_medium_index(view, medium);
    beyond[k] = ct_medium_index(view, &entered);
  }
  LANES a = l_load(own), b = l_load(beyond);
  *bad = m_or(*bad, m_from_bits(passing));
  return vi(-a / b, a / b);
}

/* By a plane's matrix, each component of d counts once; d + 2 (n.wo) n counts its error three
 * times, which between two mirrors grows with every bounce. */
static inline void mirror(const HITS *hit, const VI d[3], VI cosine, MASK inside, VI out[3]) {
  VI k = vi_of_positives(vi_add(cosine, cosine), hit->inverse);
  for (int i = 0; i < 3; i++) {
    if (!hit->solid->is_plane) {
      out[i] = vi_add(d[i], vi_by_positive(k, vi_flip(inside, hit->across[i])));
      continue;
    }
    const IV *row = hit->solid->mirror[i];
    out[i] = vi_add(vi_add(vi_mul(vi_from(row[0]), d[0]), vi_mul(vi_from(row[1]), d[1])),
                    vi_mul(vi_from(row[2]), d[2]));
  }
}

/* Refraction bends by k along the normal, k = (1 - ratio^2)/(sqrt(delta) + ratio cosine): the
 * quotient holds the cosine's error once, where the difference that it equals holds it twice. */
static inline void scatter(const SWORLD *world, const HITS *hit, const VI d[3],
                           const STREAM *rays, int at, MASK lanes, CHILD *mirrored,
                           CHILD *refracted, MASK *bad) {
  const WORLD *base = world->base;
  const double *m = base->view->material + hit->solid->object * CT_MATERIAL_COLUMNS;
  double kr = base->effects & CT_REFLECTION ? m[CT_KR] : 0;
  double kt = base->effects & CT_REFRACTION ? m[CT_KT] : 0;
  int bends = m[CT_KT] > 0, vector = at / N_LANES, nesting = base->choice[CT_NESTING];
  if (!(kr > 0) && !bends) return;
  LANES zero = l_all(0), one = l_all(1), slot = l_load(rays->slot + at);
  MASK inside = l_less(hit->cosine.h, zero);
  *bad = m_or(*bad, m_but(lanes, m_or(inside, l_less(hit->cosine.n, zero))));
  lanes = m_but(lanes, *bad);
  VI cosine = vi_flip(inside, hit->cosine), direction[3], origin[3];
  MASK total = m_none();
  if (bends) {
    VI ratio = ratio_at(world, hit, rays, at, inside, lanes, bad);
    VI square = vi_of_positives(ratio, ratio), bend = vi(square.h - one, one + square.n);
    VI delta = vi_add(bend, vi_of_positives(square, vi_of_positives(cosine, cosine)));
    MASK through = l_less(delta.n, zero);
    total = l_less(delta.h, zero);
    MASK plus = l_at_most(bend.n, zero), minus = l_at_most(bend.h, zero); /* the sign of bend */
    MASK known = m_or(total, m_and(through, m_or(plus, minus)));
    *bad = m_or(*bad, m_but(lanes, known));
    lanes = m_but(lanes, *bad);
    total = m_and(total, lanes);
    through = m_but(lanes, total);
    if (kt > 0 && m_any(through)) {
      LANES low = l_root(l_greater(-delta.n, zero)) * (1 - 4 * LANE_U);
      LANES high = l_root(l_greater(delta.h, zero));
      LANES sum_h = high + ratio.h * cosine.h, sum_n = ratio.n * -cosine.n - low;
      minus = m_but(minus, plus);
      bend = vi_of_positives(vi_flip(minus, bend), hit->inverse);
      VI k = vi(bend.n / sum_h, bend.h / -sum_n);
      MASK known_sum = l_less(sum_n, l_all(-0x1p-300));
      *bad = m_or(*bad, m_but(through, known_sum));
      through = m_and(through, known_sum);
      /* Against the facing normal where bend > 0. */
      MASK flip = m_or(m_but(inside, minus), m_but(minus, inside));
      for (int i = 0; i < 3; i++) {
        VI normal = vi_flip(flip, hit->across[i]);
        VI pull = vi_by_positive(k, vi(normal.h, normal.n));
        direction[i] = vi_add(vi_by_positive(ratio, d[i]), pull);
      }
      start_beside(world, hit, m_but(lanes, inside), direction, origin);
      int first = refracted->rays.n;
      append(refracted, vector, through, kt, origin, direction, slot);
      if (nesting != CT_NESTING_RELATIVE) {
        unsigned in = m_bits(inside);
        for (unsigned bits = m_bits(through); bits; bits &= bits - 1, first++) {
          int lane = __builtin_ctz(bits);
          refracted->entered[first] = ct_medium_crossed(nesting, rays->medium[at + lane],
                                                        hit->solid->object, in >> lane & 1);
          refracted->rays.medium[first] = &refracted->entered[first];
        }
      }
    }
    if (!(base->effects & CT_TOTAL_REFLECTION)) total = m_none();
  }
  MASK reflects = m_but(kr > 0 ? lanes : total, *bad);
  if (!m_any(reflects)) return;
  mirror(hit, d, cosine, inside, direction);
  start_beside(world, hit, inside, direction, origin);
  MASK parts[2] = {m_and(reflects, total), m_but(reflects, total)};
  for (int p = 0; p < 2; p++) {
    int first = mirrored->rays.n;
    append(mirrored, vector, parts[p], p == 0 ? 1 : kr, origin, direction, slot);
    if (nesting != CT_NESTING_RELATIVE)
      for (unsigned bits = m_bits(parts[p]); bits; bits &= bits - 1, first++)
        mirrored->rays.medium[first] = rays->medium[at + __builtin_ctz(bits)];
  }
}
