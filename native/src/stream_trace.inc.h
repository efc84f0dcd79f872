/* trace.inc.h and scatter.inc.h for bundles of rays of one depth. Every bundle meets the objects,
 * is shaded vector by vector, one pass for each object in the vector, and sends its mirrored rays
 * on as one bundle and its refracted rays as another, packed, so that lanes stay full at any depth.
 * A ray's sum takes its terms in the scalar order: base + diffuse + specular, + kr * reflected,
 * + kt * refracted.
 *
 * What a vector becomes stays in registers: storing a wide vector costs as much as several
 * operations on it. That is why all of a pass is inlined.
 */

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
