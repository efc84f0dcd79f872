/* Nearest hits of given rays, many side by side, and how fast this instruction set multiplies and
 * adds: what the speed of the former is held against. */

/* Rays of a block: they and their hits stay in the processor's nearest cache. Against a tree, many
 * share what they list. Against a few objects memory is what takes long, and small blocks let more
 * of the next one arrive meanwhile: 235, 209 and 200 million rays a second against four objects for
 * 64, 128 and 256 (Zen 4, AVX-512). */
enum { BLOCK_RAYS = 64 };

/* With as many objects, blocks are as large as the tracer's bundles, and are asked only about what a
 * bound around their rays meets. */
enum { FEWEST_BOUNDED = 8 };

/* The boxes around the origins and the directions of a block. */
static void bound_block(const COLUMNS *origin, const COLUMNS *direction, size_t n, BOX *origins,
                        BOX *directions) {
  *origins = *directions = box_of_nothing();
  for (size_t at = 0; at < n; at += N_LANES) {
    box_take(origins, m_first(n - at), vs_load(origin, at));
    box_take(directions, m_first(n - at), vs_load(direction, at));
  }
}

/* Rays of a block against a tree: as a bundle, they list what they may meet. */
static void intersect_with_tree(const STAGE *stage, const COLUMNS *origin, const COLUMNS *direction,
                                size_t n, REAL *t, LANE_ID *object) {
  SHAPE shape[LISTED];
  uint32_t listed[LISTED];
  REAL from[LISTED];
  LIST list = {.shape = shape, .object = listed, .from = from};
  BOX origins, directions;
  bound_block(origin, direction, n, &origins, &directions);
  list_targets(stage, &origins, &directions, &list);
  for (size_t at = 0; at < n; at += N_LANES) {
    HITS hits = nearest_in_tree(stage, &list, vs_load(origin, at), vs_load(direction, at), 0,
                                m_first(n - at));
    l_store(t + at, hits.t);
    i_store(object + at, hits.object);
  }
}

/* Rays of a block against every object, or those that they may meet: `may` has room for their
 * bits. */
static void intersect_in_turn(const STAGE *stage, const COLUMNS *origin, const COLUMNS *direction,
                              size_t n, uint64_t *may, REAL *t, LANE_ID *object) {
  BOX origins, directions;
  if (may) {
    bound_block(origin, direction, n, &origins, &directions);
    find_targets(stage, &origins, &directions, may);
  }
  nearest_in_columns(stage, may ? may : stage->all, origin, direction, n, 0, t, object);
}

/* Asks for rays before their turn: at the end of every page, and there are six columns of them, the
 * processor's own guesses begin anew. */
INLINE void ask_for_rays(const ct_rays *rays, size_t begin, size_t n) {
  enum { LINE = 64 / sizeof(double), NOT_NEAREST = 2 };
  size_t end = begin + n < rays->n ? begin + n : rays->n;
  for (int i = 0; i < 3; i++)
    for (size_t at = begin; at < end; at += LINE) {
      __builtin_prefetch(rays->origin[i] + at, 0, NOT_NEAREST);
      __builtin_prefetch(rays->direction[i] + at, 0, NOT_NEAREST);
    }
}

static void FN(intersect)(const void *opaque, const ct_rays *rays, size_t passes, double *t,
                          int64_t *object) {
  const STAGE *stage = opaque;
  REAL part[6][N_LANES], near[BUNDLE_RAYS];
  LANE_ID id[BUNDLE_RAYS];
  int culls = !stage->bvh && stage->n_objects >= FEWEST_BOUNDED &&
              stage->world->frame->options->search != CT_SEARCH_SCAN;
  uint64_t *may = culls ? malloc(stage->n_words * sizeof *may) : NULL; /* NULL: everything */
  size_t most = stage->bvh || may ? BUNDLE_RAYS : BLOCK_RAYS;
  for (size_t block = 0, n; block < rays->n; block += n) {
    COLUMNS c[2];
    size_t left = rays->n - block;
    n = left < most ? left / N_LANES * N_LANES : most;
    if (n > 0) {
      for (int k = 0; k < 2; k++) {
        const double *const *from = k ? rays->direction : rays->origin;
        /* Only read. */
        c[k] = (COLUMNS){(REAL *)(uintptr_t)(from[0] + block), (REAL *)(uintptr_t)(from[1] + block),
                         (REAL *)(uintptr_t)(from[2] + block)};
      }
    } else { /* what does not fill a vector */
      n = left;
      memset(part, 0, sizeof part);
      for (int i = 0; i < 3; i++) {
        memcpy(part[i], rays->origin[i] + block, n * sizeof **part);
        memcpy(part[3 + i], rays->direction[i] + block, n * sizeof **part);
      }
      for (int k = 0; k < 2; k++) c[k] = (COLUMNS){part[3 * k], part[3 * k + 1], part[3 * k + 2]};
    }
    ask_for_rays(rays, block + 3 * most, most);
    for (size_t pass = 0; pass < passes; pass++)
      if (stage->bvh)
        intersect_with_tree(stage, c, c + 1, n, near, id);
      else
        intersect_in_turn(stage, c, c + 1, n, may, near, id);
    for (size_t at = 0; at < n; at += N_LANES) {
      LANES found = l_load(near + at);
      l_store(near + at, l_blend(l_is_number(found), found, l_all((REAL)INFINITY)));
    }
    memcpy(t + block, near, n * sizeof *near);
    memcpy(object + block, id, n * sizeof *id);
  }
  free(may);
}

/* As many chains as it takes to hide how long a product and a sum take; more would not fit the
 * registers of every instruction set. */
enum { CHAINS = 12 };

/* Runs `rounds` products and as many sums in every chain, and returns how many that were. */
static double FN(multiply_and_add)(size_t rounds, double *result) {
  LANES x[CHAINS], factor = l_all((REAL)0.999), term = l_all((REAL)0.001);
  for (int k = 0; k < CHAINS; k++) x[k] = l_all((REAL)k);
  for (size_t i = 0; i < rounds; i++)
    for (int k = 0; k < CHAINS; k++) x[k] = x[k] * factor + term;
  REAL lane[N_LANES];
  for (int k = 1; k < CHAINS; k++) x[0] = x[0] + x[k];
  l_store(lane, x[0]);
  *result = to_double(lane[0]); /* so that the work is not left out */
  return 2.0 * CHAINS * N_LANES * (double)rounds;
}
