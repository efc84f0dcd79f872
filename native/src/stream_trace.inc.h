/* trace.inc.h and scatter.inc.h for bundles of rays of one depth. Every bundle meets the objects,
 * is shaded vector by vector, one pass for each object in the vector, and sends its mirrored rays
 * on as one bundle and its refracted rays as another, packed, so that lanes stay full at any depth.
 * A ray's sum takes its terms in the scalar order: base + diffuse + specular, + kr * reflected,
 * + kt * refracted.
 */

/* What a bundle can meet. */
typedef struct FN(sight) {
  uint64_t *may;  /* bits of objects: that may be hit; then, for each lamp, be in the way */
  uint64_t known; /* lamps that have been asked for */
  BOX points;     /* around the hits */
} FN(sight);
#define SIGHT FN(sight)

/* One vector of rays and what comes of it. */
typedef struct FN(here) {
  VECS direction, point;
  VECS normal, base, diffuse, specular; /* of the pass's object */
  VECS color, mirrored, refracted;
  LANES kr, kt;
  unsigned total; /* lanes of total reflection */
  SIGHT *sight;
  uint64_t *tree; /* of the vector's lanes; NULL: nobody asks */
  uint32_t *rays;
} FN(here);
#define HERE FN(here)

static void note_decision(HERE *here, unsigned lanes, uint64_t value) {
  if (!here->tree) return;
  for (unsigned k = 0; k < N_LANES; k++) {
    uint64_t mixed = ct_tree_mix(here->tree[k], value);
    here->tree[k] = lanes >> k & 1 ? mixed : here->tree[k];
  }
}

static void count_shadow_rays(STORE *store, const HERE *here, unsigned lanes) {
  unsigned n = (unsigned)__builtin_popcount(lanes);
  store->pixel->n_shadow += n;
  store->pixel->n_unreported += n;
  if (!here->rays) return;
  for (unsigned k = 0; k < N_LANES; k++) here->rays[k] += lanes >> k & 1;
}

static int is_stopped(const STORE *store) {
  return atomic_load_explicit(&store->pixel->shared->stop, memory_order_relaxed) != CT_OK;
}

/* Objects that may stand between the bundle's hits and lamp j. */
static const uint64_t *blockers_of(const STAGE *stage, SIGHT *sight, size_t j) {
  size_t k = stage->n_lamps <= CULLED_LAMPS ? j : 0;
  uint64_t *may = sight->may + (k + 1) * stage->n_words;
  if (sight->known >> k & 1) return may;
  sight->known |= UINT64_C(1) << k;
  BOUND bound;
  if (stage->n_lamps <= CULLED_LAMPS && bound_feelers(&sight->points, stage->lamp[j].at, &bound))
    cull(stage, &bound, may);
  else
    cull_nothing(stage, may);
  return may;
}

#include "stream_light.inc.h"

/* scatter_at; CT_TIR_REPLACE */
static inline void scatter_of(STORE *store, const SURFACE *s, HERE *here, VECS wo, MASK hit) {
  unsigned effects = store->stage->world->effects;
  LANES zero = l_all(0), one = l_all(1);
  LANES cosine = vs_dot(here->normal, wo);
  MASK inside = m_but(hit, l_less(zero, cosine)), total = m_none();
  VECS facing = {l_negate_where(inside, here->normal.x), l_negate_where(inside, here->normal.y),
                 l_negate_where(inside, here->normal.z)};
  cosine = l_negate_where(inside, cosine);
  LANES kr = l_all(s->kr), kt = zero;
  if (s->is_clear) {
    LANES ratio = l_blend(inside, l_all(s->ratio[1]), l_all(s->ratio[0]));
    LANES sine2 = (one - cosine) * (one + cosine), delta = one - (ratio * ratio) * sine2;
    total = m_and(hit, l_less(delta, zero));
    LANES along_normal = l_root(delta) - ratio * cosine;
    VECS refracted = vs_sub(vs_neg(vs_scale(ratio, wo)), vs_scale(along_normal, facing));
    here->refracted = vs_blend(hit, refracted, here->refracted);
    kt = l_where(m_but(hit, total), l_all(s->kt));
    if (effects & CT_TOTAL_REFLECTION) kr = l_blend(total, one, kr);
    here->kt = l_blend(hit, kt, here->kt);
    here->total |= m_bits(total);
  }
  VECS mirrored = vs_sub(vs_scale(l_all(2) * cosine, facing), wo);
  here->mirrored = vs_blend(hit, mirrored, here->mirrored);
  here->kr = l_blend(hit, kr, here->kr);
  if (!here->tree) return;
  unsigned in = m_bits(inside), all = m_bits(total), lanes = m_bits(hit);
  note_decision(here, lanes & ~in & ~all, 0);
  note_decision(here, lanes & in & ~all, 1);
  note_decision(here, lanes & ~in & all, 2);
  note_decision(here, lanes & in & all, 3);
}

/* shade, without the secondary rays, for the lanes of `hit`, which all hit object i. */
static void shade_of(STORE *store, size_t i, HERE *here, MASK hit) {
  const STAGE *stage = store->stage;
  const SHAPE *shape = stage->shape + i;
  const SURFACE *surface = stage->surface + i;
  VECS wo = vs_neg(here->direction), zero = vs_all(v_zero());
  here->base = vs_all(surface->base);
  here->diffuse = here->specular = zero;
  if (shape->is_plane) {
    here->normal = vs_all(shape->normal);
  } else {
    VECS outward = vs_sub(here->point, vs_all(shape->at));
    here->normal = vs_over(outward, vs_length(outward));
  }
  VECS color = here->base;
  if (stage->has_lights) {
    add_lights_of(store, surface, here, wo, hit);
    color = vs_add(vs_add(here->base, here->diffuse), here->specular);
  }
  here->color = vs_blend(hit, color, here->color);
  if (stage->has_scatter) scatter_of(store, surface, here, wo, hit);
}

/* ---- Bundles ---- */

static void note_first_hit(STORE *store, const HERE *here, size_t at, MASK hit) {
  const FIRST *first = &store->first;
  if (store->wants_hit)
    vs_store(&first->normal, at, vs_blend(hit, here->normal, vs_load(&first->normal, at)));
  if (!store->wants_split) return;
  const VECS *terms[] = {&here->base, &here->diffuse, &here->specular};
  for (int k = 0; k < 3; k++)
    vs_store(&first->split[k], at, vs_blend(hit, *terms[k], vs_load(&first->split[k], at)));
}

/* Sends the lanes whose weight is above 0 on along `direction`. */
static inline unsigned send(BRANCH *branch, size_t at, const HERE *here, VECS direction,
                            LANES weight) {
  MASK sent = l_less(l_all(0), weight);
  unsigned bits = m_bits(sent), n = (unsigned)__builtin_popcount(bits);
  branch->sent[at / N_LANES] = (uint16_t)bits;
  if (!bits) return 0;
  l_store(branch->weight + at, weight);
  vs_store_packed(&branch->rays.origin, branch->rays.n, sent, here->point);
  vs_store_packed(&branch->rays.direction, branch->rays.n, sent, direction);
  branch->rays.n += n;
  return n;
}

/* Adds what the branch brought back, to all that is asked for. */
static void take_back(STORE *store, const BUNDLE *bundle, const BRANCH *branch, int64_t depth,
                      int is_mirrored) {
  const BUNDLE *rays = &branch->rays;
  for (size_t at = 0, from = 0; at < bundle->n; at += N_LANES) {
    unsigned bits = branch->sent[at / N_LANES];
    if (!bits) continue;
    MASK sent = m_from_bits(bits);
    VECS c = vs_scale(l_load(branch->weight + at), vs_load_packed(&rays->color, from, sent));
    vs_store(&bundle->color, at, vs_add_where(sent, vs_load(&bundle->color, at), c));
    if (depth == 0 && store->wants_split) {
      MASK total = m_and(sent, m_from_bits(store->first.total[at / N_LANES]));
      const COLUMNS *plain = store->first.split + (is_mirrored ? 3 : 4);
      const COLUMNS *totally = store->first.split + 5;
      MASK usual = is_mirrored ? m_but(sent, total) : sent;
      vs_store(plain, at, vs_blend(usual, c, vs_load(plain, at)));
      if (is_mirrored) vs_store(totally, at, vs_blend(total, c, vs_load(totally, at)));
    }
    if (bundle->tree || bundle->rays) {
      size_t k = from;
      for (unsigned left = bits; left; left &= left - 1, k++) {
        size_t to = at + (unsigned)__builtin_ctz(left);
        if (bundle->tree) bundle->tree[to] = ct_tree_mix(bundle->tree[to], rays->tree[k]);
        if (bundle->rays) bundle->rays[to] += rays->rays[k];
      }
    }
    from += (unsigned)__builtin_popcount(bits);
  }
}

/* What lies below STREAM_LEVELS, ray by ray. */
static void trace_one_by_one(STORE *store, const BUNDLE *bundle, int64_t depth) {
  const WORLD *world = store->stage->world;
  for (size_t k = 0; k < bundle->n && !is_stopped(store); k++) {
    VEC way = v_make(bundle->direction.x[k], bundle->direction.y[k], bundle->direction.z[k]);
    VEC point = v_make(bundle->origin.x[k], bundle->origin.y[k], bundle->origin.z[k]);
    VEC direction = v_over(way, v_length(way));
    RAY ray = {v_along(point, world->epsilon, direction), direction, depth, 0, NULL};
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

/* Rays that the depth ends: what the reading `exhausted` puts in their place. */
static void end_rays(STORE *store, HERE *here, size_t at, int is_first) {
  VEC end = store->stage->exhausted;
  for (int is_refracted = 0; is_refracted < 2; is_refracted++) {
    LANES weight = is_refracted ? here->kt : here->kr;
    MASK ended = l_less(l_all(0), weight);
    VECS c = vs_scale(weight, vs_all(end));
    here->color = vs_add_where(ended, here->color, c);
    if (!is_first || !store->wants_split) continue;
    MASK total = is_refracted ? m_none() : m_and(ended, m_from_bits(here->total));
    const COLUMNS *plain = store->first.split + 3 + is_refracted, *totally = store->first.split + 5;
    vs_store(plain, at, vs_blend(m_but(ended, total), c, vs_load(plain, at)));
    vs_store(totally, at, vs_blend(total, c, vs_load(totally, at)));
  }
}

static void trace_bundle(STORE *store, const BUNDLE *bundle, int64_t depth) {
  const STAGE *stage = store->stage;
  const WORLD *world = stage->world;
  int is_first = depth == 0;
  if (depth > STREAM_LEVELS) {
    trace_one_by_one(store, bundle, depth);
    return;
  }
  store->pixel->n_unreported += (uint32_t)bundle->n;
  if (store->pixel->n_unreported >= 4096) ct_pixel_report(store->pixel);
  size_t mark = store->used;
  REAL ts[BUNDLE_RAYS + N_LANES];
  LANE_ID ids[BUNDLE_RAYS + N_LANES];
  int sends = stage->has_scatter && depth < world->frame->max_depth;
  BRANCH mirrored = {.weight = NULL}, refracted = {.weight = NULL};
  if (sends) {
    mirrored = take_branch(store, bundle->n);
    refracted = take_branch(store, bundle->n);
  }
  VECS missed = vs_all(is_first ? stage->background : stage->missed), zero = vs_all(v_zero());
  SIGHT sight = {.may = take(store, (1 + CULLED_LAMPS) * stage->n_words, sizeof *sight.may),
                 .known = 0, .points = box_of_nothing()};
  BOX origins = box_of_nothing(), directions = box_of_nothing();
  for (size_t at = 0; at < bundle->n; at += N_LANES) {
    MASK live = m_first(bundle->n - at);
    VECS origin = vs_load(&bundle->origin, at), direction = vs_load(&bundle->direction, at);
    /* Of length 1, as rounding would grow from bounce to bounce inside glass. */
    direction = vs_over(direction, vs_length(direction));
    if (!is_first) origin = vs_along(origin, l_all(world->epsilon), direction);
    vs_store(&bundle->direction, at, direction);
    vs_store(&bundle->origin, at, origin);
    box_take(&origins, live, origin);
    box_take(&directions, live, direction);
  }
  BOUND bound;
  if (bound_rays(&origins, &directions, &bound))
    cull(stage, &bound, sight.may);
  else
    cull_nothing(stage, sight.may);
  for (size_t at = 0; at < bundle->n; at += N_LANES) {
    if (is_stopped(store)) return;
    MASK live = m_first(bundle->n - at);
    VECS origin = vs_load(&bundle->origin, at), direction = vs_load(&bundle->direction, at);
    HITS hits = nearest_of(stage, sight.may, origin, direction, is_first, live);
    VECS point = vs_along(origin, hits.t, direction);
    box_take(&sight.points, m_and(live, l_is_number(hits.t)), point);
    vs_store(&bundle->origin, at, point);
    l_store(ts + at, hits.t);
    i_store(ids + at, hits.object);
  }
  for (size_t at = 0; at < bundle->n; at += N_LANES) {
    if (is_stopped(store)) return;
    MASK live = m_first(bundle->n - at);
    HITS hits = {l_load(ts + at), i_load(ids + at)};
    HERE here; /* an initialiser would clear all of it, every time */
    here.direction = vs_load(&bundle->direction, at);
    here.point = vs_load(&bundle->origin, at);
    here.color = missed;
    here.mirrored = here.refracted = zero;
    here.kr = here.kt = l_all(0);
    here.total = 0;
    here.sight = &sight;
    here.tree = NULL;
    here.rays = NULL;
    unsigned left = m_bits(m_and(live, l_is_number(hits.t)));
    unsigned sky = m_bits(live) & ~left;
    if (bundle->rays) {
      here.rays = bundle->rays + at;
      for (int k = 0; k < N_LANES; k++) here.rays[k] = 1;
    }
    if (bundle->tree) {
      here.tree = bundle->tree + at;
      memset(here.tree, 0, N_LANES * sizeof *here.tree);
      note_decision(&here, sky, 1);
    }
    if (is_first && store->wants_hit) {
      i_store(store->first.object + at, hits.object);
      l_store(store->first.t + at, hits.t);
      vs_store(&store->first.normal, at, zero);
    }
    if (is_first && store->wants_split) {
      for (int k = 0; k < CT_CONTRIBUTIONS; k++) vs_store(&store->first.split[k], at, zero);
      vs_store(&store->first.split[0], at, missed);
    }
    while (left) {
      LANE_ID i = ids[at + (unsigned)__builtin_ctz(left)];
      MASK hit = m_and(m_from_bits(left), i_equal(hits.object, i_all(i)));
      left &= ~m_bits(hit);
      if (here.tree) note_decision(&here, m_bits(hit), (uint64_t)(i + 2));
      shade_of(store, (size_t)i, &here, hit);
      if (is_first) note_first_hit(store, &here, at, hit);
    }
    if (is_first && store->wants_split) store->first.total[at / N_LANES] = (uint16_t)here.total;
    if (sends) {
      store->pixel->n_reflected += send(&mirrored, at, &here, here.mirrored, here.kr);
      store->pixel->n_refracted += send(&refracted, at, &here, here.refracted, here.kt);
    } else if (stage->has_scatter) {
      end_rays(store, &here, at, is_first);
    }
    vs_store(&bundle->color, at, here.color);
  }
  if (sends) {
    if (mirrored.rays.n) trace_bundle(store, &mirrored.rays, depth + 1);
    take_back(store, bundle, &mirrored, depth, 1);
    if (refracted.rays.n) trace_bundle(store, &refracted.rays, depth + 1);
    take_back(store, bundle, &refracted, depth, 0);
  }
  store->used = mark;
}
