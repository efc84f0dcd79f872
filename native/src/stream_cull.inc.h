/* Which objects a bundle's rays can meet at all: a bound around the rays, against every sphere.
 *
 * A bound is the set of points within radius + spread * s of center + s * axis, 0 <= s <= length:
 * a cone around rays that part, a narrowing one around feelers on their way to a lamp. A sphere
 * outside it by CULL_MARGIN of the distances involved is left out. The kernel's test rounds a
 * line's distance from a centre, and a root's place before a lamp, by some REAL_UNIT of those
 * distances, or by REAL_UNIT / CULL_MARGIN of themselves where a difference of squares cancels; the
 * margin is thousands of times that, so the test would have said no for every ray. Where a bound is
 * no number or its squares leave the comfortable range, nothing is left out.
 */
#define CULL_MARGIN ((REAL)(REAL_DIGITS == 24 ? 0x1p-7 : 0x1p-22))
#define CULL_LEAST ((REAL)(REAL_DIGITS == 24 ? 0x1p-100 : 0x1p-900))
#define CULL_MOST ((REAL)(REAL_DIGITS == 24 ? 0x1p100 : 0x1p900))

typedef struct FN(bound) {
  VEC center, axis; /* axis of length 1 */
  REAL radius, spread, length;
} FN(bound);
#define BOUND FN(bound)

/* The box around vectors in the lanes given so far. */
typedef struct FN(box) {
  VECS low, high;
} FN(box);
#define BOX FN(box)

static inline BOX box_of_nothing(void) {
  LANES far = l_all((REAL)INFINITY);
  return (BOX){{far, far, far}, {-far, -far, -far}};
}

static inline void box_take(BOX *box, MASK m, VECS a) {
  box->low = vs_lesser_where(m, a, box->low);
  box->high = vs_greater_where(m, a, box->high);
}

static REAL least_lane(LANES a) {
  REAL lane[N_LANES];
  l_store(lane, a);
  for (int k = 1; k < N_LANES; k++) lane[0] = less(lane[k], lane[0]) ? lane[k] : lane[0];
  return lane[0];
}

/* The middle of the box, and in *reach the distance of its corners from there. */
static VEC box_middle(const BOX *box, REAL *reach) {
  REAL half = from_double(0.5);
  VECS top = vs_neg(box->high);
  VEC low = v_make(least_lane(box->low.x), least_lane(box->low.y), least_lane(box->low.z));
  VEC high = v_neg(v_make(least_lane(top.x), least_lane(top.y), least_lane(top.z)));
  *reach = mul(half, v_length(v_sub(high, low)));
  return v_scale(half, v_add(high, low));
}

/* Around rays of those origins and directions. Returns 0 where they part too widely. */
static int bound_rays(const BOX *origins, const BOX *directions, BOUND *bound) {
  REAL reach;
  VEC middle = box_middle(directions, &reach);
  REAL length = v_length(middle);
  if (!less(mul(from_double(1.25), reach), length)) return 0;
  bound->center = box_middle(origins, &bound->radius);
  bound->axis = v_over(middle, length);
  bound->spread = quo(reach, length);
  bound->length = CULL_MOST;
  return 1;
}

/* Around feelers from those points to the lamp. Returns 0 where the lamp is too near. */
static int bound_feelers(const BOX *points, VEC lamp, BOUND *bound) {
  bound->center = box_middle(points, &bound->radius);
  VEC way = v_sub(lamp, bound->center);
  bound->length = v_length(way);
  if (!less(mul(from_double(1.25), bound->radius), bound->length)) return 0;
  bound->axis = v_over(way, bound->length);
  bound->spread = neg(quo(bound->radius, bound->length));
  return 1;
}

/* A bound in lanes. */
typedef struct FN(culler) {
  VECS center, axis;
  LANES slant, spread, length, radius;
} FN(culler);
#define CULLER FN(culler)

INLINE CULLER culler_of(const BOUND *bound) {
  REAL one = from_double(1), k = bound->spread;
  return (CULLER){.center = vs_all(bound->center),
                  .axis = vs_all(bound->axis),
                  .slant = l_all(quo(k, root(sub(one, mul(k, k))))),
                  .spread = l_all(k),
                  .length = l_all(bound->length),
                  .radius = l_all(bound->radius)};
}

/* The lanes whose spheres no ray within the bound meets. */
INLINE MASK cleared(const CULLER *c, VECS at, LANES r) {
  LANES zero = l_all(0), margin = l_all(CULL_MARGIN);
  VECS w = vs_sub(at, c->center);
  LANES along = vs_dot(w, c->axis), square = vs_dot(w, w);
  LANES across2 = l_greater(square - along * along, zero), across = l_root(across2);
  /* Where the gap between the bound's surface and the centre is least: it is convex in s. */
  LANES s = l_lesser(l_greater(along + across * c->slant, zero), c->length), off = along - s;
  LANES gap = l_root(across2 + off * off) - (c->radius + c->spread * s);
  LANES scale = (l_abs(along) + across) + (c->radius + r);
  MASK clear = m_and(l_less(l_all(CULL_LEAST), square), l_less(square, l_all(CULL_MOST)));
  return m_and(clear, l_less(r + margin * scale, gap));
}

/* Writes a bit for every object that rays within the bound may meet. Planes are never left out. */
static void cull(const STAGE *stage, const BOUND *bound, uint64_t *may) {
  CULLER culler = culler_of(bound);
  for (size_t i = 0; i < stage->n_objects; i += N_LANES) {
    MASK clear = cleared(&culler, vs_load(&stage->center, i), l_load(stage->radius + i));
    uint64_t bits = ~(uint64_t)m_bits(clear) & m_bits(m_first(stage->n_objects - i));
    if (i % 64 == 0) may[i / 64] = 0;
    may[i / 64] |= bits << i % 64;
  }
}

/* Writes a bit for every object that rays of those origins and directions may meet. */
static void find_targets(const STAGE *stage, const BOX *origins, const BOX *directions,
                         uint64_t *may) {
  BOUND bound;
  if (bound_rays(origins, directions, &bound))
    cull(stage, &bound, may);
  else
    memcpy(may, stage->all, stage->n_words * sizeof *may);
}

/* Writes a bit for every object that may stand between those points and lamp j. */
static void find_blockers(const STAGE *stage, const BOX *points, int culls, size_t j,
                          uint64_t *may) {
  BOUND bound;
  if (culls && bound_feelers(points, stage->lamp[j].at, &bound))
    cull(stage, &bound, may);
  else
    memcpy(may, stage->all, stage->n_words * sizeof *may);
}
