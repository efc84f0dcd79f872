/* Which solids the rays of a stream, and then their feelers to a light, can meet at all.
 *
 * A cone is the set of points within radius + spread s of center + s axis, 0 <= s <= length: it
 * opens around rays, and narrows around feelers on their way to a light. A sphere farther from it
 * than 8E and CULL_MARGIN of the distances involved is passed over. With E below r/8, nothing of
 * `meet` (set_stream_hit.inc.h) lives there in any lane: |l|, |f| and the way from the light are
 * each above r + 8E where they count, and so no bound of a distance or of a shadow is touched. A
 * pixel's bits therefore do not depend on what else is in its stream. What is no number is asked.
 */
#define CULL_MARGIN 0x1p-22

/* The greatest of each component, and of its negative. */
typedef struct SET_FN(box) {
  LANES n[3], h[3];
} BOX;

static inline void box_clear(BOX *box) {
  for (int k = 0; k < 3; k++) box->n[k] = box->h[k] = l_all(-(double)INFINITY);
}

static inline void box_take(BOX *box, MASK lanes, const VI a[3]) {
  for (int k = 0; k < 3; k++) {
    box->n[k] = l_greater_where(lanes, a[k].n, box->n[k]);
    box->h[k] = l_greater_where(lanes, a[k].h, box->h[k]);
  }
}

static double greatest_of_all(LANES a) {
  double lane[N_LANES];
  l_store(lane, a);
  for (int k = 1; k < N_LANES; k++) lane[0] = lane[k] > lane[0] ? lane[k] : lane[0];
  return lane[0];
}

/* The middle of a box, and in *reach how far its corners are from there. */
static void box_middle(const BOX *box, double middle[3], double *reach) {
  double square = 0;
  for (int k = 0; k < 3; k++) {
    double n = greatest_of_all(box->n[k]), h = greatest_of_all(box->h[k]), half = (h + n) * 0.5;
    middle[k] = (h - n) * 0.5;
    square += half * half;
  }
  *reach = sqrt(square);
}

typedef struct SET_FN(cone) {
  double center[3], axis[3]; /* axis of length 1 */
  double radius, spread, length;
  double error, slope; /* E = error + |c| slope, of any ray in it */
} CONE;

static double length3(const double a[3]) { return sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]); }

/* Fills the errors, given what bounds |o| and |p|, eo and ed (complete_middle). */
static void bound_errors(CONE *cone, double n, double eo, double ed) {
  cone->slope = ed * 4 + 16 * LANE_U;
  cone->error = (eo * 4 + n * cone->slope) + 0x1p-500;
}

/* Around rays. Returns 0 where they part too widely. */
static int cone_of_rays(const BOX *origins, const BOX *directions, double eo, double ed,
                        CONE *cone) {
  double middle[3], reach;
  box_middle(directions, middle, &reach);
  double length = length3(middle);
  if (!(reach * 1.25 < length)) return 0;
  box_middle(origins, cone->center, &cone->radius);
  for (int k = 0; k < 3; k++) cone->axis[k] = middle[k] / length;
  cone->spread = reach / length;
  cone->length = 0x1p300;
  bound_errors(cone, (length3(cone->center) + cone->radius) * 2, eo, ed);
  return 1;
}

/* Around the ways from hits, known to within `error`, to a light. Returns 0 where it is too near. */
static int cone_of_feelers(const BOX *hits, double error, double epsilon, const double *light,
                           CONE *cone) {
  double reach;
  box_middle(hits, cone->center, &reach);
  cone->radius = reach + error;
  for (int k = 0; k < 3; k++) cone->axis[k] = light[k] - cone->center[k];
  cone->length = length3(cone->axis);
  if (!(cone->radius * 1.25 < cone->length)) return 0;
  for (int k = 0; k < 3; k++) cone->axis[k] /= cone->length;
  cone->spread = -cone->radius / cone->length;
  /* More than middle_to_light says of the worst: no light is nearer than a fifth of the length. */
  double nearest = cone->length * 0.125, n = (length3(light) + cone->length) * 4 + epsilon;
  double ed = (error / nearest) * 16 + 64 * LANE_U;
  bound_errors(cone, n, (error * 8 + ed * epsilon) + n * (64 * LANE_U), ed);
  return 1;
}

/* The bits of the solids that a ray in the cone may meet; planes always. */
static uint64_t solids_in(const SWORLD *world, const CONE *cone) {
  uint64_t may = 0;
  double k = cone->spread;
  LANES slant = l_all(k / sqrt(1 - k * k)), zero = l_all(0), margin = l_all(CULL_MARGIN);
  for (size_t i = 0; i < world->n_solids; i += N_LANES) {
    LANES along = zero, square = zero, r = l_load(world->columns[3] + i);
    for (int c = 0; c < 3; c++) {
      LANES w = l_load(world->columns[c] + i) - cone->center[c];
      along = along + w * cone->axis[c];
      square = square + w * w;
    }
    LANES across2 = l_greater(square - along * along, zero), across = l_root(across2);
    /* Where the gap between the cone's surface and the centre is least: it is convex in s. */
    LANES s = l_lesser(l_greater(along + across * slant, zero), l_all(cone->length));
    LANES off = along - s, gap = l_root(across2 + off * off) - (s * k + cone->radius);
    LANES scale = (l_abs(along) + across) + (r + cone->radius);
    LANES e = (l_load(world->columns[4] + i) * cone->slope + cone->error) * 8;
    MASK away = m_and(l_less(e, r), l_less((r + e) + margin * scale, gap));
    away = m_and(away, l_less(l_all(0x1p-400), square));
    may |= (uint64_t)(~m_bits(away) & m_bits(m_first(world->n_solids - i))) << i;
  }
  return may;
}

/* What the rays of a stream can meet. */
typedef struct SET_FN(sight) {
  int culls;                        /* 0: everything may stand anywhere */
  uint64_t targets;                 /* bits of solids */
  uint64_t blockers[CULLED_LIGHTS]; /* as far as `known` says */
  uint64_t known;                   /* bits of lights */
  double n, eo, ed;                 /* bounds of |o|, and of the errors of o and d */
  BOX hits;
  LANES farthest, widest; /* of the hits: distance, and how well it is known */
} SIGHT;

/* Finds what the rays may hit. */
static void look(const SWORLD *world, const STREAM *rays, SIGHT *sight) {
  BOX origins, directions;
  CONE cone;
  sight->culls = 1;
  sight->known = 0;
  box_clear(&sight->hits);
  sight->farthest = sight->widest = l_all(0);
  LANES eo = l_all(0), ed = eo;
  box_clear(&origins);
  box_clear(&directions);
  for (int at = 0; at < rays->n; at += N_LANES) {
    MASK lanes = m_first((size_t)(rays->n - at));
    VI o[3], d[3];
    load_rays(rays, at, o, d);
    for (int k = 0; k < 3; k++) {
      eo = l_greater_where(lanes, o[k].n + o[k].h, eo);
      ed = l_greater_where(lanes, d[k].n + d[k].h, ed);
    }
    box_take(&origins, lanes, o);
    box_take(&directions, lanes, d);
  }
  double reach, center[3];
  box_middle(&origins, center, &reach);
  sight->n = length3(center) + reach;
  sight->eo = greatest_of_all(eo) + sight->n * (4 * LANE_U);
  sight->ed = greatest_of_all(ed) + 4 * LANE_U;
  sight->targets = cone_of_rays(&origins, &directions, sight->eo, sight->ed, &cone)
                       ? solids_in(world, &cone)
                       : ~UINT64_C(0);
}

/* Takes note of where hits are. */
static inline void note_hits(SIGHT *sight, const MIDDLE *q, const NEAREST *nearest, MASK lanes) {
  LANES n = nearest->n, h = nearest->h, t = (h - n) * 0.5;
  VI hits[3];
  for (int k = 0; k < 3; k++) {
    LANES x = q->o[k] + t * q->d[k];
    hits[k] = vi(-x, x);
  }
  box_take(&sight->hits, lanes, hits);
  sight->farthest = l_greater_where(lanes, h, sight->farthest);
  sight->widest = l_greater_where(lanes, h + n, sight->widest);
}

/* The bits of the solids that may stand before a light. */
static uint64_t blockers_of(const SWORLD *world, SIGHT *sight, size_t light) {
  if (!sight->culls || light >= CULLED_LIGHTS) return ~UINT64_C(0);
  /* Rays start aside of the hits there, by more than the errors that a cone knows. */
  if (world->base->choice[CT_OFFSET] == CT_OFFSET_MITSUBA) return ~UINT64_C(0);
  if (sight->known >> light & 1) return sight->blockers[light];
  double far = greatest_of_all(sight->farthest), wide = greatest_of_all(sight->widest);
  double error = (sight->eo * 2 + far * (sight->ed * 2)) +
                 (wide * 2 + (sight->n + far) * (16 * LANE_U));
  CONE cone;
  sight->known |= UINT64_C(1) << light;
  sight->blockers[light] =
      cone_of_feelers(&sight->hits, error, world->base->epsilon.hi,
                      world->base->view->lights + light * CT_LIGHT_COLUMNS + 3, &cone)
          ? solids_in(world, &cone)
          : ~UINT64_C(0);
  return sight->blockers[light];
}
