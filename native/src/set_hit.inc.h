/* Which object a set of rays may hit, and which may stand before a light.
 *
 * An intersection has outcomes, not an answer: up to two roots that may be the hit, and the
 * possibility of a miss. Outcomes that lie surely behind a sure hit are dropped; if more than one
 * is left, the caller's script decides which is followed (decide), and all are in turn.
 *
 * Sphere: f = o - c, b = -f.d, disc = r^2 - |f + b*d|^2, roots b -+ sqrt(disc), each met with
 * (|f|^2 - r^2) over the other root where that does not cancel. Plane: (P - o).n / (d.n) with the
 * normal as in the file, whose doubles are exact. Directions are of length 1 in real arithmetic.
 */

typedef struct SET_FN(ray) {
  IV3 origin, direction;
  int64_t depth;
  int primary;
  const ct_medium *medium;
} RAY;

typedef struct SET_FN(outcome) {
  IV t;
  int sure; /* the object is hit at t or nearer, for every ray of the set */
  int64_t object;
} OUTCOME;

typedef struct SET_FN(pixel_state) {
  const WORLD *world;
  const ct_set_limits *limits;
  ct_set_status status; /* CT_SET_DECIDED until something ends the run */
  unsigned char script[CT_MAX_DECISIONS], n_options[CT_MAX_DECISIONS];
  int n_decided;
  ct_decision first;
  uint64_t n_rays;
} STATE;

/* One of n outcomes, by the script; beyond its end, the first. */
static int decide(STATE *s, int n, int kind, int64_t depth, int64_t object) {
  if (s->n_decided == 0) s->first = (ct_decision){kind, depth, object};
  if (s->n_decided >= CT_MAX_DECISIONS) {
    s->status = CT_SET_BUDGET;
    return 0;
  }
  s->n_options[s->n_decided] = (unsigned char)n;
  return s->script[s->n_decided++];
}

static void give_up(STATE *s, ct_set_status why, int64_t depth, int64_t object) {
  if (s->n_decided == 0) s->first = (ct_decision){CT_DECISION_PRECISION, depth, object};
  if (s->status == CT_SET_DECIDED) s->status = why;
}

static BOUND error_of(const WORLD *world, BOUND scale) {
  return b_mul(b_from(world->kappa), scale);
}

static IV3 unit_error3(const WORLD *world, IV3 direction) {
  return world->kappa > 0 ? i3_widen(direction, b_from(world->kappa)) : direction;
}

/* Adds the root t to the outcomes if it may lie beyond t_min; says whether it surely does. */
static int add_root(OUTCOME *out, int *n, IV t, double t_min, int exists) {
  BOUND least = b_from(t_min);
  if (!b_less(least, t.hi)) return 0;
  int sure = b_less(least, b_neg(t.nlo));
  if (!sure) t = iv(b_min(t.nlo, b_neg(least)), t.hi);
  out[(*n)++] = (OUTCOME){t, sure && exists, -1};
  return sure;
}

static int sphere_outcomes(const WORLD *world, const RAY *ray, const double *g, int on_surface,
                           double t_min, OUTCOME *out) {
  int n = 0;
  IV3 f = i3_sub(ray->origin, i3_from(g));
  IV r = i_from(g[3]), r2 = i_square(r);
  if (world->kappa > 0) f = i3_widen(f, error_of(world, i3_magnitude(ray->origin)));
  IV b = i_neg(i3_dot(f, ray->direction));
  if (on_surface) {
    add_root(out, &n, i_add(b, b), t_min, 1);
    return n;
  }
  IV f2 = i3_square(f), c = i_sub(f2, r2);
  if (world->kappa > 0) c = i_widen(c, error_of(world, b_add(r2.hi, f2.hi)));
  if (i_is_negative(b) && i_is_positive(c)) return 0; /* outside and moving away */
  IV l2 = i3_square(i3_along(f, b, ray->direction)), disc = i_sub(r2, l2);
  if (world->kappa > 0) disc = i_widen(disc, error_of(world, b_add(r2.hi, l2.hi)));
  if (i_is_negative(disc)) return 0;
  int exists = i_not_negative(disc);
  IV s = i_sqrt(disc), near = i_sub(b, s), far = i_add(b, s);
  if (i_is_positive(far)) near = i_meet(near, i_over_positive(c, far));
  if (i_is_negative(near)) far = i_meet(far, i_over(c, near));
  if (world->kappa > 0) {
    near = i_widen(near, error_of(world, i_magnitude(near)));
    far = i_widen(far, error_of(world, i_magnitude(far)));
  }
  /* Inside for sure: the near root lies behind. */
  int inside = i_is_negative(c) && !(t_min > 0);
  if (!inside && add_root(out, &n, near, t_min, exists)) return n;
  int first = n;
  if (!add_root(out, &n, far, t_min, exists)) return n;
  /* The far root is sure: so is a hit at it or nearer. */
  for (int i = 0; i < first; i++) out[i].sure = 0;
  return n;
}

static int plane_outcomes(STATE *s, const RAY *ray, const double *g, double t_min, OUTCOME *out) {
  const WORLD *world = s->world;
  int n = 0;
  IV3 normal = i3_from(g + 3), way = i3_sub(i3_from(g), ray->origin);
  IV slope = i3_dot(ray->direction, normal), rise = i3_dot(way, normal);
  if (world->kappa > 0) {
    BOUND scale = i3_magnitude(normal);
    slope = i_widen(slope, error_of(world, scale));
    rise = i_widen(rise, error_of(world, b_mul(scale, b_add(i3_magnitude(i3_from(g)),
                                                            i3_magnitude(ray->origin)))));
  }
  if (i_is_zero(slope)) return 0; /* in the plane or parallel to it: a miss */
  if (i_is_positive(slope) || i_is_negative(slope)) {
    IV t = i_over(rise, slope);
    if (world->kappa > 0) t = i_widen(t, error_of(world, i_magnitude(t)));
    add_root(out, &n, t, t_min, 1);
    return n;
  }
  /* Nearly parallel: no upper bound for t, and perhaps no hit. */
  BOUND steepest = i_magnitude(slope);
  IV distance = i_is_negative(rise) ? i_neg(rise) : rise;
  BOUND nlo = i_is_positive(distance) ? b_div(distance.nlo, steepest) : b_from(0);
  add_root(out, &n, iv(nlo, b_from((double)INFINITY)), t_min, 0);
  return n;
}

static int outcomes_of(STATE *s, const RAY *ray, size_t i, double t_min, OUTCOME *out) {
  const WORLD *world = s->world;
  const double *g = world->view->geometry + i * CT_GEOMETRY_COLUMNS;
  double far = world->frame->options->far;
  int on_surface = ray->primary && world->frame->eye_on[i] &&
                   world->choice[CT_OFFSET] != CT_OFFSET_MITSUBA;
  int n = 0;
  if (world->view->kind[i] == CT_SPHERE)
    n = sphere_outcomes(world, ray, g, on_surface, t_min, out);
  else if (!on_surface)
    n = plane_outcomes(s, ray, g, t_min, out);
  for (int k = 0; k < n; k++) {
    out[k].object = (int64_t)i;
    if (!(far > 0)) continue;
    if (b_less(b_from(far), b_neg(out[k].t.nlo))) {
      n = k; /* what comes later is farther */
      break;
    }
    if (b_less(b_from(far), out[k].t.hi)) {
      out[k].sure = 0;
      out[k].t.hi = b_from(far);
    }
  }
  return n;
}

/* ---- Many objects (bvh.h) ---- */

enum { MOST_LISTED = 512 };

/* A walk along all rays of the set. Their directions are of length 1, or off by the error of the
 * arithmetic under test, by which it may move a sphere, too. */
static void walk_along(const WORLD *world, const RAY *ray, ct_walk *walk) {
  const IV o[3] = {ray->origin.x, ray->origin.y, ray->origin.z};
  const IV d[3] = {ray->direction.x, ray->direction.y, ray->direction.z};
  double o_low[3], o_high[3], d_low[3], d_high[3];
  for (int k = 0; k < 3; k++) {
    o_low[k] = -b_to_double(o[k].nlo);
    o_high[k] = b_to_double(o[k].hi);
    d_low[k] = -b_to_double(d[k].nlo);
    d_high[k] = b_to_double(d[k].hi);
  }
  ct_walk_start(walk, world->frame->bvh, o_low, o_high, d_low, d_high,
                CT_WALK_SLACK + 64 * world->kappa);
}

/* Objects that may be hit, as far as is known. */
typedef struct SET_FN(listing) {
  uint32_t *object;
  int n;
  double before; /* something is hit for sure at this or nearer */
} LISTING;

/* Adds object i; 0 where there is no room. */
static int list_object(STATE *s, const RAY *ray, const FILTER *filter, size_t i, LISTING *list) {
  OUTCOME found[2];
  if (s->world->is_twin[i] || !may_meet(s->world, filter, i, list->before)) return 1;
  int n = outcomes_of(s, ray, i, 0, found);
  for (int k = 0; k < n; k++)
    if (found[k].sure) list->before = fmin(list->before, b_to_double(found[k].t.hi));
  if (n == 0) return 1;
  if (list->n == MOST_LISTED) {
    int kept = 0;
    for (int k = 0; k < list->n; k++)
      if (may_meet(s->world, filter, list->object[k], list->before))
        list->object[kept++] = list->object[k];
    list->n = kept;
    if (kept == MOST_LISTED) return 0;
  }
  int k = list->n++;
  for (; k > 0 && list->object[k - 1] > i; k--) list->object[k] = list->object[k - 1];
  list->object[k] = (uint32_t)i;
  return 1;
}

/* Lists the objects that may be hit, in the order of the file, and returns how many there are; -1
 * where there is no room for all. Those left out have no outcome, or lie surely behind a sure hit. */
static __attribute__((noinline)) int list_nearest(STATE *s, const RAY *ray,
                                                  uint32_t object[MOST_LISTED]) {
  const ct_bvh *bvh = s->world->frame->bvh;
  LISTING list = {object, 0, (double)INFINITY};
  FILTER filter = filter_of(ray->origin, ray->direction);
  for (size_t k = 0; k < bvh->n_apart; k++)
    if (!list_object(s, ray, &filter, bvh->apart[k], &list)) return -1;
  ct_walk walk;
  size_t first;
  unsigned n;
  walk_along(s->world, ray, &walk);
  while (ct_walk_next(&walk, ct_walk_before(list.before), &first, &n))
    for (size_t k = first; k < first + n; k++)
      if (!list_object(s, ray, &filter, bvh->object[k], &list)) return -1;
  return list.n;
}

/* The hit that the script chooses among those possible; object -1: none. Not inlined, so that its list
 * does not lie in every level of the recursion. */
static __attribute__((noinline)) OUTCOME nearest_outcome(STATE *s, const RAY *ray) {
  OUTCOME list[CT_MAX_CANDIDATES + 2], found[2], none = {.object = -1};
  int n = 0, has_sure = 0;
  BOUND sure_by = b_from((double)INFINITY);
  double before = (double)INFINITY;
  uint32_t near[MOST_LISTED];
  int n_near = s->world->frame->bvh ? list_nearest(s, ray, near) : -1;
  size_t n_asked = n_near < 0 ? s->world->view->n_objects : (size_t)n_near;
  FILTER filter = filter_of(ray->origin, ray->direction);
  for (size_t asked = 0; asked < n_asked; asked++) {
    size_t i = n_near < 0 ? asked : near[asked];
    if (s->world->is_twin[i] || !may_meet(s->world, &filter, i, before)) continue;
    int n_found = outcomes_of(s, ray, i, 0, found);
    for (int k = 0; k < n_found; k++) {
      /* At or behind a sure hit: a tie goes to the object that comes first in the file. */
      if (has_sure && !b_less(b_neg(found[k].t.nlo), sure_by)) continue;
      if (found[k].sure && (!has_sure || b_less(found[k].t.hi, sure_by))) {
        sure_by = found[k].t.hi;
        before = b_to_double(sure_by);
        has_sure = 1;
        int kept = 0;
        for (int j = 0; j < n; j++)
          if (!b_less(sure_by, b_neg(list[j].t.nlo))) list[kept++] = list[j];
        n = kept;
      }
      if (n >= CT_MAX_CANDIDATES) {
        give_up(s, CT_SET_BUDGET, ray->depth, (int64_t)i);
        return none;
      }
      list[n++] = found[k];
    }
  }
  if (n == 0) return none;
  if (n == 1 && has_sure) return list[0];
  if (!has_sure) list[n++] = none;
  OUTCOME hit = list[decide(s, n, CT_DECISION_NEAREST, ray->depth, list[0].object)];
  if (hit.object >= 0 && !b_less(hit.t.hi, b_from(1e150))) {
    give_up(s, CT_SET_PRECISION, ray->depth, hit.object);
    return none;
  }
  return hit;
}

typedef enum { SHADOW_NONE, SHADOW_POSSIBLE, SHADOW_SURE } shadow_answer;

/* Where a light lies on a sphere, one root is the light itself, at `reach`, and the other 2b minus
 * it. */
static shadow_answer own_light_blocked(const WORLD *world, size_t i, const RAY *ray, IV reach,
                                       IV limit) {
  const double *g = world->view->geometry + i * CT_GEOMETRY_COLUMNS;
  if (world->view->kind[i] == CT_PLANE) return SHADOW_NONE;
  IV b = i_neg(i3_dot(i3_sub(ray->origin, i3_from(g)), ray->direction));
  IV other = i_sub(i_add(b, b), reach), least = i_from(world->frame->options->shadow_min);
  if (world->kappa > 0) other = i_widen(other, error_of(world, i_magnitude(other)));
  if (i_less(least, other) && i_less(other, limit)) return SHADOW_SURE;
  return i_may_be_less(least, other) && i_may_be_less(other, limit) ? SHADOW_POSSIBLE
                                                                    : SHADOW_NONE;
}

/* What is asked of the objects before light j, which is at `reach`, and nearer than `limit`. Both
 * NULL: at any distance. */
typedef struct SET_FN(feeler) {
  STATE *state;
  const RAY *ray;
  size_t light;
  const IV *reach, *limit;
  FILTER filter;
  double before;
} FEELER;

/* Does object i stand there? */
static shadow_answer blocked_by(const FEELER *f, size_t i) {
  const WORLD *world = f->state->world;
  const IV *limit = f->limit;
  OUTCOME found[2];
  if (!may_meet(world, &f->filter, i, f->before)) return SHADOW_NONE;
  if (world->choice[CT_GLASS_SHADOW] == CT_GLASS_SHADOW_CLEAR &&
      world->view->material[i * CT_MATERIAL_COLUMNS + CT_KT] > 0)
    return SHADOW_NONE;
  if (limit && world->choice[CT_OFFSET] != CT_OFFSET_MITSUBA && !(world->kappa > 0) &&
      ct_light_is_on(world->frame, f->light, i))
    return own_light_blocked(world, i, f->ray, *f->reach, *limit);
  shadow_answer answer = SHADOW_NONE;
  int n = outcomes_of(f->state, f->ray, i, world->frame->options->shadow_min, found);
  for (int k = 0; k < n; k++) {
    if (limit && !i_may_be_less(found[k].t, *limit)) continue;
    if (found[k].sure && (!limit || i_less(found[k].t, *limit))) return SHADOW_SURE;
    answer = SHADOW_POSSIBLE;
  }
  return answer;
}

static __attribute__((noinline)) shadow_answer find_blocker_in_tree(const FEELER *f) {
  const ct_bvh *bvh = f->state->world->frame->bvh;
  shadow_answer answer = SHADOW_NONE;
  ct_walk walk;
  size_t first;
  unsigned n;
  for (size_t k = 0; k < bvh->n_apart && answer != SHADOW_SURE; k++) {
    shadow_answer one = blocked_by(f, bvh->apart[k]);
    if (one > answer) answer = one;
  }
  walk_along(f->state->world, f->ray, &walk);
  while (answer != SHADOW_SURE && ct_walk_next(&walk, ct_walk_before(f->before), &first, &n))
    for (size_t k = first; k < first + n; k++) {
      shadow_answer one = blocked_by(f, bvh->object[k]);
      if (one > answer) answer = one;
    }
  return answer;
}

static shadow_answer find_blocker(STATE *s, const RAY *ray, size_t j, const IV *reach,
                                  const IV *limit) {
  FEELER f = {s, ray, j, reach, limit, filter_of(ray->origin, ray->direction),
              limit ? b_to_double(limit->hi) : (double)INFINITY};
  if (s->world->frame->bvh) return find_blocker_in_tree(&f);
  shadow_answer answer = SHADOW_NONE;
  for (size_t i = 0; i < s->world->view->n_objects && answer != SHADOW_SURE; i++) {
    shadow_answer one = blocked_by(&f, i);
    if (one > answer) answer = one;
  }
  return answer;
}
