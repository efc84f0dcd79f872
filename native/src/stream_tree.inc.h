/* What of a scene with a tree of boxes (bvh.h) a bundle's rays may meet.
 *
 * Rays side by side see few spheres between them. A walk along the beam around them lists these once
 * for the bundle, nearest first, and every vector asks the list until all of its rays have been hit
 * before what is left of it. Where the list is full, what is not on it lies beyond a distance; a ray
 * that gets there walks the tree on its own and asks a leaf's spheres side by side, as all do that
 * part too widely for a beam. What is apart from the tree everybody asks. A tie goes to the first in
 * the file whatever the order of asking, so all ways find the same.
 */

/* Spheres in a list, at most (measured on clouds of 1e3 to 1e6 spheres). */
enum { LISTED = 128 };

typedef struct FN(list) {
  SHAPE *shape; /* n of them */
  uint32_t *object;
  REAL *from; /* the sphere is hit no nearer */
  size_t n;
  REAL beyond; /* spheres that are not listed are hit no nearer; infinity: there are none */
} FN(list);
#define LIST FN(list)

/* Distances of boxes are rounded up: a hit at t is in none that begins beyond this times t. */
#define AHEAD ((REAL)1.000001)

/* Spheres of a leaf, in lanes. */
typedef struct FN(leaf_part) {
  VECS center;
  LANES radius;
  MASK wanted;
} FN(leaf_part);
#define LEAF_PART FN(leaf_part)

/* From number `at` on of the leaf of n spheres whose first has that number in the tree. */
INLINE LEAF_PART leaf_part(const STAGE *stage, size_t first, size_t n, size_t at) {
  const REAL *leaf = stage->leaf + 4 * first + at;
  return (LEAF_PART){{l_load(leaf), l_load(leaf + n), l_load(leaf + 2 * n)},
                     l_load(leaf + 3 * n), m_first(n - at)};
}

INLINE ROOTS leaf_roots(const STAGE *stage, size_t first, size_t n, size_t at, VECS origin,
                        VECS direction, LANES t_min) {
  LEAF_PART part = leaf_part(stage, first, n, at);
  ROOTS roots = sphere_roots_at(part.center, part.radius * part.radius, origin, direction, t_min,
                                part.wanted);
  if (stage->world->has_far)
    roots.valid = m_but(roots.valid, l_less(l_all(stage->world->far), roots.t));
  return roots;
}

static inline void start_walk(const STAGE *stage, VEC origin, VEC direction, ct_walk *walk) {
  double o[3], d[3];
  v_store(origin, o);
  v_store(direction, d);
  ct_walk_start(walk, stage->bvh, o, o, d, d, REAL_SLACK);
}

/* Takes the leaves' nearest hit for *t and *object if it is nearer than they are. */
static void walk_to_nearest(const STAGE *stage, VEC origin, VEC direction, REAL *t,
                            LANE_ID *object) {
  ct_walk walk;
  size_t first;
  unsigned n;
  LANES zero = l_all(0);
  VECS o = vs_all(origin), d = vs_all(direction);
  start_walk(stage, origin, direction, &walk);
  while (ct_walk_next_on_ray(&walk, ct_walk_before(to_double(*t)), &first, &n))
    for (size_t at = 0; at < n; at += N_LANES) {
      ROOTS roots = leaf_roots(stage, first, n, at, o, d, zero);
      /* Nothing is hit yet where t is no number. */
      MASK nearer = m_but(roots.valid, l_less(l_all(*t), roots.t));
      unsigned left = m_bits(nearer);
      if (!left) continue;
      REAL found[N_LANES];
      l_store(found, roots.t);
      for (; left; left &= left - 1) {
        unsigned k = (unsigned)__builtin_ctz(left);
        LANE_ID i = (LANE_ID)stage->bvh->object[first + at + k];
        if (less(*t, found[k]) || (!less(found[k], *t) && *object >= 0 && *object < i)) continue;
        *t = found[k];
        *object = i;
      }
    }
}

static int walk_to_blocker(const STAGE *stage, VEC origin, VEC direction, REAL limit) {
  ct_walk walk;
  size_t first;
  unsigned n;
  LANES t_min = l_all(stage->world->shadow_min);
  VECS o = vs_all(origin), d = vs_all(direction);
  float before = ct_walk_before(to_double(limit));
  start_walk(stage, origin, direction, &walk);
  while (ct_walk_next_on_ray(&walk, before, &first, &n))
    for (size_t at = 0; at < n; at += N_LANES) {
      ROOTS roots = leaf_roots(stage, first, n, at, o, d, t_min);
      if (m_any(m_and(roots.valid, l_less(roots.t, l_all(limit))))) return 1;
    }
  return 0;
}

/* The lanes in which object i, found at t, is nearer than what was found so far. */
INLINE MASK nearer_of(ROOTS roots, size_t i, const HITS *hits) {
  MASK nearer = m_and(roots.valid, l_not_at_least(roots.t, hits->t));
  MASK tie = m_but(m_and(roots.valid, l_at_most(roots.t, hits->t)), nearer);
  if (!m_any(tie)) return nearer;
  LANE_ID object[N_LANES];
  unsigned first = 0;
  i_store(object, hits->object);
  for (unsigned k = 0; k < N_LANES; k++) first |= (unsigned)(object[k] > (LANE_ID)i) << k;
  return m_or(nearer, m_and(tie, m_from_bits(first)));
}

INLINE void offer_shape(const STAGE *stage, const SHAPE *shape, size_t object, VECS origin,
                        VECS direction, int primary, MASK wanted, HITS *hits) {
  ROOTS roots = roots_of(stage, shape, origin, direction, primary, l_all(0), wanted);
  MASK nearer = nearer_of(roots, object, hits);
  hits->t = l_blend(nearer, roots.t, hits->t);
  hits->object = i_blend(nearer, i_all((LANE_ID)object), hits->object);
}

/* The lanes of `wanted` that may be hit from `from` on nearer than what was found. */
INLINE MASK undecided(const HITS *hits, REAL from, MASK wanted) {
  return m_but(wanted, l_less(hits->t * l_all(AHEAD), l_all(from)));
}

/* As nearest_in_columns. A list that leaves most rays of a vector undecided is of no more use. */
INLINE HITS nearest_in_tree(const STAGE *stage, LIST *list, VECS origin, VECS direction,
                            int primary, MASK wanted) {
  HITS hits = {l_all((REAL)NAN), i_all(-1)};
  const ct_bvh *bvh = stage->bvh;
  for (size_t k = 0; k < bvh->n_apart; k++)
    offer_shape(stage, stage->shape + k, bvh->apart[k], origin, direction, primary, wanted, &hits);
  for (size_t k = 0; k < list->n; k++) {
    if (k % 4 == 0 && !m_any(undecided(&hits, list->from[k], wanted))) return hits;
    offer_shape(stage, list->shape + k, list->object[k], origin, direction, 0, wanted, &hits);
  }
  if (!(list->beyond < (REAL)INFINITY)) return hits;
  MASK left_over = undecided(&hits, list->beyond, wanted);
  if (2 * __builtin_popcount(m_bits(left_over)) > __builtin_popcount(m_bits(wanted)))
    list->n = 0, list->beyond = 0;
  wanted = left_over;
  if (!m_any(wanted)) return hits;
  REAL o[3][N_LANES], d[3][N_LANES], t[N_LANES];
  LANE_ID object[N_LANES];
  COLUMNS from = {o[0], o[1], o[2]}, way = {d[0], d[1], d[2]};
  vs_store(&from, 0, origin);
  vs_store(&way, 0, direction);
  l_store(t, hits.t);
  i_store(object, hits.object);
  for (unsigned left = m_bits(wanted); left; left &= left - 1) {
    unsigned k = (unsigned)__builtin_ctz(left);
    walk_to_nearest(stage, v_make(o[0][k], o[1][k], o[2][k]), v_make(d[0][k], d[1][k], d[2][k]),
                    t + k, object + k);
  }
  return (HITS){l_load(t), i_load(object)};
}

/* As blocked_of. */
INLINE MASK blocked_in_tree(const STAGE *stage, const LIST *list, size_t j, VECS origin,
                            VECS direction, LANES reach, LANES limit, MASK wanted) {
  const ct_bvh *bvh = stage->bvh;
  MASK blocked = m_none();
  for (size_t k = 0; k < bvh->n_apart + list->n; k++) {
    int is_apart = k < bvh->n_apart;
    const SHAPE *s = is_apart ? stage->shape + k : list->shape + (k - bvh->n_apart);
    /* What a lamp lies on stands apart. */
    int has_lamp = is_apart && stage->lamp[j].is_on_a_surface &&
                   ct_light_is_on(stage->world->frame, j, bvh->apart[k]);
    MASK here = blocking(stage, s, has_lamp, origin, direction, reach, limit, wanted);
    blocked = m_or(blocked, here);
    wanted = m_but(wanted, here);
    if (!m_any(wanted)) return blocked;
  }
  if (!(list->beyond < (REAL)INFINITY)) return blocked;
  REAL o[3][N_LANES], d[3][N_LANES], ends[N_LANES];
  COLUMNS from = {o[0], o[1], o[2]}, way = {d[0], d[1], d[2]};
  vs_store(&from, 0, origin);
  vs_store(&way, 0, direction);
  l_store(ends, limit);
  unsigned dark = 0;
  for (unsigned left = m_bits(wanted); left; left &= left - 1) {
    unsigned k = (unsigned)__builtin_ctz(left);
    VEC at = v_make(o[0][k], o[1][k], o[2][k]), to = v_make(d[0][k], d[1][k], d[2][k]);
    dark |= (unsigned)walk_to_blocker(stage, at, to, ends[k]) << k;
  }
  return m_or(blocked, m_from_bits(dark));
}

/* ---- Lists ---- */

/* Adds the spheres of a leaf that the bound does not leave out; 0 where they are too many. */
static int list_leaf(const STAGE *stage, const CULLER *culler, size_t first, unsigned n, float from,
                     LIST *list) {
  for (size_t at = 0; at < n; at += N_LANES) {
    LEAF_PART part = leaf_part(stage, first, n, at);
    MASK clear = cleared(culler, part.center, part.radius);
    for (unsigned left = m_bits(m_but(part.wanted, clear)); left; left &= left - 1) {
      uint32_t i = stage->bvh->object[first + at + (unsigned)__builtin_ctz(left)];
      if (list->n == LISTED) return 0;
      read_shape(stage->world, i, list->shape + list->n);
      list->from[list->n] = from;
      list->object[list->n++] = i;
    }
  }
  return 1;
}

/* Lists what rays within the bound may meet, all of whose origins and directions lie in those
 * boxes, up to `before` times the direction. */
static void list_beam(const STAGE *stage, const BOUND *bound, const double o_low[3],
                      const double o_high[3], const double d_low[3], const double d_high[3],
                      float before, LIST *list) {
  ct_walk walk;
  size_t first;
  unsigned n;
  float from = 0;
  int is_next;
  CULLER culler = culler_of(bound);
  ct_walk_start(&walk, stage->bvh, o_low, o_high, d_low, d_high, REAL_SLACK);
  while ((is_next = ct_walk_next_in_order(&walk, before, &first, &n, &from)) > 0)
    if (!list_leaf(stage, &culler, first, n, from, list)) break;
  list->beyond = is_next ? (REAL)from : (REAL)INFINITY;
}

static void box_ends(const BOX *box, double low[3], double high[3]) {
  VECS top = vs_neg(box->high);
  low[0] = to_double(least_lane(box->low.x)), high[0] = -to_double(least_lane(top.x));
  low[1] = to_double(least_lane(box->low.y)), high[1] = -to_double(least_lane(top.y));
  low[2] = to_double(least_lane(box->low.z)), high[2] = -to_double(least_lane(top.z));
}

static void list_targets(const STAGE *stage, const BOX *origins, const BOX *directions,
                         LIST *list) {
  BOUND bound;
  double o[2][3], d[2][3];
  list->n = 0;
  list->beyond = 0;
  if (!bound_rays(origins, directions, &bound)) return;
  box_ends(origins, o[0], o[1]);
  box_ends(directions, d[0], d[1]);
  list_beam(stage, &bound, o[0], o[1], d[0], d[1], FLT_MAX, list);
}

/* The feelers go from the points to the lamp, which is 1 away in units of the whole way. */
static void list_blockers(const STAGE *stage, const BOX *points, int culls, size_t j, LIST *list) {
  BOUND bound;
  double o[2][3], d[2][3], lamp[3];
  VEC at = stage->lamp[j].at;
  list->n = 0;
  list->beyond = 0;
  if (!culls || !bound_feelers(points, at, &bound)) return;
  box_ends(points, o[0], o[1]);
  v_store(at, lamp);
  for (int k = 0; k < 3; k++) {
    d[0][k] = lamp[k] - o[1][k];
    d[1][k] = lamp[k] - o[0][k];
  }
  list_beam(stage, &bound, o[0], o[1], d[0], d[1], 1.001f, list);
  /* There is no knowing that nothing blocks a light but by asking all. */
  if (list->beyond < (REAL)INFINITY) list->n = 0;
}
