/* trace.inc.h and scatter.inc.h for bundles of rays of one depth. Every bundle meets the objects,
 * is shaded vector by vector, one pass for each object in the vector, and sends its mirrored rays
 * on as one bundle and its refracted rays as another, packed, so that lanes stay full at any depth.
 * A ray's sum takes its terms in the scalar order: base + diffuse + specular, + kr * reflected,
 * + kt * refracted.
 *
 * What a vector becomes stays in registers: storing a wide vector costs as much as several
 * operations on it. That is why all of a pass is inlined.
 */

/* What a bundle can meet. */
typedef struct FN(sight) {
  uint64_t *may;  /* bits of objects: that may be hit; then, for each lamp, be in the way */
  uint64_t known; /* lamps that have been asked for */
  BOX points;     /* around the hits */
  LIST *list;     /* with a tree, in place of `may` */
} FN(sight);
#define SIGHT FN(sight)

/* Where a vector stands in its bundle. */
typedef struct FN(row) {
  size_t at;
  uint64_t *tree; /* of the vector's rays; NULL: nobody asks */
  uint32_t *rays; /* of the vector's rays; NULL: nobody asks */
  SIGHT *sight;
  const REAL *slack; /* of the vector's rays */
  REAL most;         /* that a secondary ray returns, where rays are pruned */
} FN(row);
#define ROW FN(row)

static void mix_lanes(uint64_t *tree, unsigned lanes, uint64_t value) {
  for (unsigned k = 0; k < N_LANES; k++) {
    uint64_t mixed = ct_tree_mix(tree[k], value);
    tree[k] = lanes >> k & 1 ? mixed : tree[k];
  }
}

INLINE void note_decision(const ROW *row, unsigned lanes, uint64_t value) {
  if (row->tree && lanes) mix_lanes(row->tree, lanes, value);
}

INLINE void count_shadow_rays(STORE *store, const ROW *row, unsigned lanes) {
  unsigned n = (unsigned)__builtin_popcount(lanes);
  store->pixel->n_shadow += n;
  store->pixel->n_unreported += n;
  for (unsigned k = 0; row->rays && k < N_LANES; k++) row->rays[k] += lanes >> k & 1;
}

static int is_stopped(const STORE *store) {
  return atomic_load_explicit(&store->pixel->shared->stop, memory_order_relaxed) != CT_OK;
}

/* blocked_of, among the objects that may stand between the bundle's hits and lamp j. */
INLINE MASK blocked_in_sight(const STAGE *stage, SIGHT *sight, size_t j, VECS origin,
                             VECS direction, LANES reach, LANES limit, MASK wanted) {
  int culls = stage->n_lamps <= CULLED_LAMPS;
  size_t k = culls ? j : 0;
  int is_known = sight->known >> k & 1;
  sight->known |= UINT64_C(1) << k;
  if (stage->bvh) {
    LIST *list = sight->list + k + 1;
    if (!is_known) list_blockers(stage, &sight->points, culls, j, list);
    return blocked_in_tree(stage, list, j, origin, direction, reach, limit, wanted);
  }
  uint64_t *may = sight->may + (k + 1) * stage->n_words;
  if (!is_known) find_blockers(stage, &sight->points, culls, j, may);
  return blocked_of(stage, may, j, origin, direction, reach, limit, wanted);
}

#include "stream_light.inc.h"

/* ---- One pass ---- */

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

/* ---- Bundles ---- */

/* Adds what a branch brought back, to all that is asked for. */
static void take_back(const STORE *store, const BUNDLE *bundle, const BRANCH *branch, int term,
                      int is_first) {
  const BUNDLE *rays = &branch->rays;
  size_t from = 0;
  for (size_t p = 0; p < branch->n_parcels; p++) {
    size_t at = branch->parcel[p].at;
    unsigned lanes = branch->parcel[p].lanes;
    MASK sent = m_from_bits(lanes);
    LANES weight = l_load(branch->weight + from);
    VECS c = vs_unpack(sent, vs_scale(weight, vs_load(&rays->color, from)));
    vs_store(&bundle->color, at, vs_add_where(sent, vs_load(&bundle->color, at), c));
    if (is_first && store->wants_split) {
      MASK total = m_from_bits(term == TERM_REFLECTION ? store->first.total[at / N_LANES] : 0);
      note_term(store, term, at, m_but(sent, total), c);
      note_term(store, TERM_TOTAL, at, m_and(sent, total), c);
    }
    if (bundle->tree || bundle->rays) {
      size_t k = from;
      for (unsigned left = lanes; left; left &= left - 1, k++) {
        size_t to = at + (unsigned)__builtin_ctz(left);
        if (bundle->tree) bundle->tree[to] = ct_tree_mix(bundle->tree[to], rays->tree[k]);
        if (bundle->rays) bundle->rays[to] += rays->rays[k];
      }
    }
    from += (unsigned)__builtin_popcount(lanes);
  }
}

/* What lies below STREAM_LEVELS, ray by ray. */
static void trace_one_by_one(STORE *store, const BUNDLE *bundle, int64_t depth) {
  const WORLD *world = store->stage->world;
  for (size_t k = 0; k < bundle->n && !is_stopped(store); k++) {
    VEC way = v_make(bundle->direction.x[k], bundle->direction.y[k], bundle->direction.z[k]);
    VEC point = v_make(bundle->origin.x[k], bundle->origin.y[k], bundle->origin.z[k]);
    VEC direction = v_over(way, v_length(way));
    RAY ray = {v_along(point, world->epsilon, direction), direction, depth, 0, NULL,
               bundle->slack ? bundle->slack[k] : from_double(0)};
    uint64_t tree = 0;
    store->pixel->n_rays = 0;
    VEC color = FN(trace)(world, store->pixel, &ray, NULL, &tree);
    bundle->color.x[k] = color.x;
    bundle->color.y[k] = color.y;
    bundle->color.z[k] = color.z;
    if (bundle->tree) bundle->tree[k] = tree;
    if (bundle->rays) bundle->rays[k] = store->pixel->n_rays;
  }
}

/* A vector of the bundle's rays as they set out. */
typedef struct FN(rays) {
  VECS origin, direction;
} FN(rays);
#define RAYS FN(rays)

INLINE RAYS set_out(const STAGE *stage, const BUNDLE *bundle, size_t at, int is_first) {
  RAYS r = {vs_load(&bundle->origin, at), vs_load(&bundle->direction, at)};
  /* Of length 1, as rounding would grow from bounce to bounce inside glass. */
  r.direction = vs_over(r.direction, vs_length(r.direction));
  if (!is_first) r.origin = vs_along(r.origin, l_all(stage->world->epsilon), r.direction);
  return r;
}

/* Finds what the bundle may hit, and what it hits, and leaves the hits' points in place of the
 * origins. */
INLINE void look_ahead(const STORE *store, const BUNDLE *bundle, SIGHT *sight, int is_first,
                       REAL *t, LANE_ID *object) {
  const STAGE *stage = store->stage;
  BOX origins = box_of_nothing(), directions = box_of_nothing(), points = box_of_nothing();
  for (size_t at = 0; at < bundle->n; at += N_LANES) {
    RAYS r = set_out(stage, bundle, at, is_first);
    MASK live = m_first(bundle->n - at);
    vs_store(&bundle->direction, at, r.direction);
    vs_store(&bundle->origin, at, r.origin);
    box_take(&origins, live, r.origin);
    box_take(&directions, live, r.direction);
  }
  if (stage->bvh)
    list_targets(stage, &origins, &directions, sight->list);
  else
    find_targets(stage, &origins, &directions, sight->may);
  if (!stage->bvh)
    nearest_in_columns(stage, sight->may, &bundle->origin, &bundle->direction, bundle->n, is_first,
                       t, object);
  for (size_t at = 0; at < bundle->n && !is_stopped(store); at += N_LANES) {
    MASK live = m_first(bundle->n - at);
    VECS origin = vs_load(&bundle->origin, at), direction = vs_load(&bundle->direction, at);
    LANES distance;
    if (stage->bvh) {
      HITS hits = nearest_in_tree(stage, sight->list, origin, direction, is_first, live);
      distance = hits.t;
      l_store(t + at, hits.t);
      i_store(object + at, hits.object);
    } else {
      distance = l_load(t + at);
    }
    VECS point = vs_along(origin, distance, direction);
    box_take(&points, m_and(live, l_is_number(distance)), point);
    vs_store(&bundle->origin, at, point);
  }
  sight->points = points;
}

static void trace_bundle(STORE *store, const BUNDLE *bundle, int64_t depth);

INLINE void trace_rays(STORE *store, const BUNDLE *bundle, int64_t depth, int is_first,
                       int prunes) {
  const STAGE *stage = store->stage;
  store->pixel->n_unreported += (uint32_t)bundle->n;
  if (store->pixel->n_unreported >= 4096) ct_pixel_report(store->pixel);
  size_t mark = store->used;
  BRANCH branches[2];
  REAL most = from_double(0);
  int sends = stage->has_scatter && depth < stage->world->frame->max_depth;
  for (int k = 0; sends && k < 2; k++) branches[k] = take_branch(store, bundle->n);
  if (prunes && sends) most = most_returned(stage->world, depth + 1);
  VECS missed = vs_all(is_first ? stage->background : stage->missed), zero = vs_all(v_zero());
  REAL t[BUNDLE_RAYS + N_LANES];
  LANE_ID object[BUNDLE_RAYS + N_LANES];
  SIGHT sight;
  sight.may = take(store, (1 + CULLED_LAMPS) * stage->n_words, sizeof *sight.may);
  sight.list = stage->bvh ? take_lists(store) : NULL;
  sight.known = 0;
  look_ahead(store, bundle, &sight, is_first, t, object);
  for (size_t at = 0; at < bundle->n; at += N_LANES) {
    if (is_stopped(store)) break;
    MASK live = m_first(bundle->n - at);
    VECS direction = vs_load(&bundle->direction, at), point = vs_load(&bundle->origin, at);
    HITS hits = {l_load(t + at), i_load(object + at)};
    unsigned left = m_bits(m_and(live, l_is_number(hits.t)));
    ROW row = {.at = at, .sight = &sight, .most = most};
    if (prunes) row.slack = bundle->slack + at;
    if (bundle->rays) {
      row.rays = bundle->rays + at;
      for (int k = 0; k < N_LANES; k++) row.rays[k] = 1;
    }
    if (bundle->tree) {
      row.tree = bundle->tree + at;
      memset(row.tree, 0, N_LANES * sizeof *row.tree);
      note_decision(&row, m_bits(live) & ~left, 1);
    }
    if (is_first && store->wants_hit) {
      i_store(store->first.object + at, hits.object);
      l_store(store->first.t + at, hits.t);
      vs_store(&store->first.normal, at, zero);
    }
    if (is_first && store->wants_split) {
      store->first.total[at / N_LANES] = 0;
      for (int k = 0; k < CT_CONTRIBUTIONS; k++) vs_store(&store->first.split[k], at, zero);
      vs_store(&store->first.split[TERM_BASE], at, missed);
    }
    VECS color = missed;
    while (left) {
      LANE_ID i = object[at + (unsigned)__builtin_ctz(left)];
      MASK hit = m_and(m_from_bits(left), i_equal(hits.object, i_all(i)));
      left &= ~m_bits(hit);
      note_decision(&row, m_bits(hit), (uint64_t)(i + 2));
      shade_of(store, (size_t)i, &row, point, direction, hit, is_first, prunes,
               sends ? branches : NULL, &color);
    }
    vs_store(&bundle->color, at, color);
  }
  /* Even a frame that is given up gives back its room: whoever called may send another branch. */
  for (int k = 0; sends && k < 2 && !is_stopped(store); k++) {
    if (!branches[k].rays.n) continue;
    trace_bundle(store, &branches[k].rays, depth + 1);
    take_back(store, bundle, branches + k, TERM_REFLECTION + k, is_first);
  }
  store->used = mark;
}

/* Pruning is known when compiled, and stands apart, so that frames without it pay nothing. */
APART void trace_pruned(STORE *store, const BUNDLE *bundle, int64_t depth) {
  if (depth == 0)
    trace_rays(store, bundle, depth, 1, 1);
  else
    trace_rays(store, bundle, depth, 0, 1);
}

static void trace_bundle(STORE *store, const BUNDLE *bundle, int64_t depth) {
  if (depth > STREAM_LEVELS)
    trace_one_by_one(store, bundle, depth);
  else if (bundle->slack)
    trace_pruned(store, bundle, depth);
  else
    trace_rays(store, bundle, depth, 0, 0);
}

static void trace_first(STORE *store, const BUNDLE *bundle) {
  if (bundle->slack)
    trace_pruned(store, bundle, 0);
  else
    trace_rays(store, bundle, 0, 1, 0);
}
