/* The spheres in a tree of boxes (bvh.h) that the rays of a vector may meet.
 *
 * A lane must not feel its neighbours, nor how many there are, so every lane is asked about all that
 * `meet` may find for it, and what is passed over has no outcome in it. With E of a sphere at most
 * `error` and less than an eighth of every radius, what `meet` lets pass has
 * |l|^2 (1 - E/r) <= r^2 + E r + E^2 + 8u(r^2 + |l|^2), so |l| < r + 2E, and both bounds of a root lie
 * where the ray is within r + 5E of the centre: the walk's boxes are moved by 8E. A lane with a
 * larger E is left to the scalar kernel.
 */

static double least_of(const double *lane, unsigned bits) {
  double least = (double)INFINITY;
  for (; bits; bits &= bits - 1) {
    double x = lane[__builtin_ctz(bits)];
    least = x < least ? x : least;
  }
  return least;
}

static double greatest_lane(LANES a, MASK group) {
  double lane[N_LANES];
  l_store(lane, -a);
  return -least_of(lane, m_bits(group));
}

static double least_lane(LANES a, MASK group) {
  double lane[N_LANES];
  l_store(lane, a);
  return least_of(lane, m_bits(group));
}

/* Fills a bound of E for every sphere in the tree, as `meet` has it in the end, from f itself; says
 * for which lanes it is small enough. */
static MASK knows_tree(const SWORLD *world, const MIDDLE *q, LANES *error) {
  const ct_bvh *bvh = world->bvh;
  LANES size = q->eo * 2.0 + 3 * bvh->reach;
  for (int k = 0; k < 3; k++) size = size + l_abs(q->o[k] - bvh->middle[k]);
  *error = (q->error + size * q->slope) * 1.01;
  return l_less(*error * 8.0, l_all(world->bvh->least_radius));
}

/* Starts a walk along the rays of some lanes, and returns which: all where they keep together. */
static MASK start_walk(const SWORLD *world, const MIDDLE *q, LANES error, MASK lanes,
                       ct_walk *walk) {
  MASK group = lanes;
  double o_low[3], o_high[3], d_low[3], d_high[3];
  for (int attempt = 0; attempt < 2; attempt++) {
    double apart = 0;
    for (int k = 0; k < 3; k++) {
      LANES reach = q->eo + error * 8.0;
      o_low[k] = least_lane(q->o[k] - reach, group);
      o_high[k] = greatest_lane(q->o[k] + reach, group);
      d_low[k] = least_lane(q->d[k] - q->ed, group);
      d_high[k] = greatest_lane(q->d[k] + q->ed, group);
      apart = fmax(apart, d_high[k] - d_low[k]);
    }
    if (apart < 0.05) break;
    unsigned bits = m_bits(group);
    group = m_from_bits(bits & ~(bits - 1)); /* one of them */
  }
  ct_walk_start(walk, world->bvh, o_low, o_high, d_low, d_high, CT_WALK_SLACK);
  return group;
}

/* Of a sphere, what `meet` asks for. */
static inline SOLID sphere_in_tree(const SWORLD *world, size_t i) {
  const double *g = world->base->view->geometry + i * CT_GEOMETRY_COLUMNS;
  SOLID s;
  s.object = i;
  s.is_plane = 0;
  memcpy(s.g, g, sizeof s.g);
  s.size = fabs(g[0]) + fabs(g[1]) + fabs(g[2]);
  s.radius = g[3];
  s.square = i_square(i_from(g[3]));
  s.inverse_radius = 1 / g[3]; /* rounded upward, as all here */
  return s;
}

/* Offers what of the tree may be nearest, and returns the lanes that it was asked for. */
APART MASK offer_tree(const SWORLD *world, const MIDDLE *q, MASK lanes, NEAREST *best) {
  LANES error;
  MASK known = m_and(lanes, knows_tree(world, q, &error));
  size_t first;
  unsigned n;
  for (MASK left = known; m_any(left);) {
    ct_walk walk;
    MASK group = start_walk(world, q, error, left, &walk);
    left = m_but(left, group);
    float before = ct_walk_before(greatest_lane(best->h, group));
    while (ct_walk_next(&walk, before, &first, &n)) {
      for (size_t k = first; k < first + n; k++) {
        size_t i = world->bvh->object[k];
        if (world->base->is_twin[i]) continue;
        SOLID s = sphere_in_tree(world, i);
        offer_sphere(best, q, &s, i, group);
      }
      before = ct_walk_before(greatest_lane(best->h, group));
    }
  }
  return known;
}
