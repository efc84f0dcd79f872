/* What a bundle's rays, and their feelers to the lamps, may meet; where a vector of it stands. */

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
