/* Nearest hits of given rays, many side by side, and how fast this instruction set multiplies and
 * adds: what the speed of the former is held against. */

/* Rays of a block: they and their hits stay in the processor's nearest cache. */
enum { BLOCK_RAYS = 256 };

static inline COLUMNS columns_at(const ct_rays *rays, int origin, size_t at) {
  const double *const *c = origin ? rays->origin : rays->direction;
  return (COLUMNS){(REAL *)(uintptr_t)(c[0] + at), (REAL *)(uintptr_t)(c[1] + at),
                   (REAL *)(uintptr_t)(c[2] + at)};
}

INLINE void intersect_vector(const STAGE *stage, VECS origin, VECS direction, MASK live, size_t n,
                             double *t, int32_t *object) {
  REAL near[N_LANES];
  LANE_ID id[N_LANES];
  HITS hits = nearest_of(stage, stage->all, origin, direction, 0, live);
  l_store(near, l_blend(l_is_number(hits.t), hits.t, l_all((REAL)INFINITY)));
  i_store(id, hits.object);
  for (size_t k = 0; k < n; k++) {
    t[k] = near[k];
    object[k] = (int32_t)id[k];
  }
}

static void FN(intersect)(const void *opaque, const ct_rays *rays, size_t passes, double *t,
                          int32_t *object) {
  const STAGE *stage = opaque;
  size_t n = rays->n, whole = n / N_LANES * N_LANES;
  for (size_t block = 0; block < whole; block += BLOCK_RAYS) {
    size_t end = block + BLOCK_RAYS < whole ? block + BLOCK_RAYS : whole;
    for (size_t pass = 0; pass < passes; pass++)
      for (size_t at = block; at < end; at += N_LANES) {
        COLUMNS from = columns_at(rays, 1, at), to = columns_at(rays, 0, at);
        intersect_vector(stage, vs_load(&from, 0), vs_load(&to, 0), m_first(N_LANES), N_LANES,
                         t + at, object + at);
      }
  }
  if (whole == n) return;
  /* What is left does not fill a vector. */
  REAL part[6][N_LANES] = {{0}};
  for (size_t k = 0; k < n - whole; k++)
    for (int i = 0; i < 3; i++) {
      part[i][k] = (REAL)rays->origin[i][whole + k];
      part[3 + i][k] = (REAL)rays->direction[i][whole + k];
    }
  COLUMNS from = {part[0], part[1], part[2]}, to = {part[3], part[4], part[5]};
  intersect_vector(stage, vs_load(&from, 0), vs_load(&to, 0), m_first(n - whole), n - whole,
                   t + whole, object + whole);
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
