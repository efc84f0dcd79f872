/* Illumination, secondary rays and recursion over sets of rays (specification 3.2, 4.1, 4.2).
 *
 * Written anew from the specification, not from the point kernel: r.wo is 2(n.l)(n.wo) - l.wo, and
 * directions are never normalised again, as they have length 1 in real arithmetic.
 */

/* Mitsuba's constants (its math.h): 1500 and 15000 times 2^-24, and its near plane. */
#define SET_MITSUBA_RAY 0x1.77p-14
#define SET_MITSUBA_SHADOW 0x1.d4cp-11
#define SET_MITSUBA_NEAR 1e-2
/* An undecided light that can add no more than this is enclosed with and without. */
#define SET_NEGLIGIBLE 1e-13

typedef struct SET_FN(hit) {
  size_t object;
  IV3 point, normal, wo;
  IV cosine; /* normal.wo */
} HIT;

static IV3 SET_FN(trace)(STATE *s, const RAY *ray);

static IV3 offset_point(const WORLD *world, const HIT *hit, IV3 toward, int is_shadow) {
  if (!is_shadow && world->choice[CT_EPSILON_FOR] == CT_EPSILON_FOR_SHADOW) return hit->point;
  int offset = world->choice[CT_OFFSET];
  if (offset == CT_OFFSET_DIRECTION) return i3_along(hit->point, world->epsilon, toward);
  IV step = world->epsilon;
  if (offset == CT_OFFSET_MITSUBA) {
    IV x = i_hull(hit->point.x, i_neg(hit->point.x)), y = i_hull(hit->point.y, i_neg(hit->point.y)),
       z = i_hull(hit->point.z, i_neg(hit->point.z));
    BOUND most = b_max(b_max(x.hi, y.hi), z.hi);
    /* The least magnitude that the largest component may have. */
    BOUND least = b_from(0);
    IV parts[3] = {hit->point.x, hit->point.y, hit->point.z};
    for (int k = 0; k < 3; k++)
      least = b_max(least, b_max(b_neg(parts[k].nlo), b_neg(parts[k].hi)));
    IV extent = iv(b_neg(least), most);
    step = i_mul(i_add(i_from(1), extent), i_from(SET_MITSUBA_RAY));
  }
  IV side = i3_dot(hit->normal, toward);
  IV3 out = i3_along(hit->point, step, hit->normal);
  if (i_not_negative(side)) return out;
  IV3 in = i3_along(hit->point, i_neg(step), hit->normal);
  return i_is_negative(side) ? in : i3_hull(in, out);
}

/* ---- Lights ---- */

/* Whether light j is blocked: SHADOW_POSSIBLE where that is open. */
static shadow_answer shadow_of(STATE *s, const RAY *ray, const HIT *hit, size_t j, IV3 light,
                               IV3 to_light, IV distance) {
  const WORLD *world = s->world;
  int light_counts = world->choice[CT_SHADOW_DISTANCE] == CT_SHADOW_DISTANCE_LIGHT;
  RAY feeler = {offset_point(world, hit, to_light, 1), to_light, ray->depth, 0, NULL};
  IV limit = i_sub(distance, world->epsilon);
  if (world->choice[CT_OFFSET] != CT_OFFSET_DIRECTION) {
    IV3 way = i3_sub(light, feeler.origin);
    limit = i3_length(way);
    if (!i_is_positive(limit)) {
      give_up(s, CT_SET_PRECISION, ray->depth, (int64_t)hit->object);
      return SHADOW_NONE;
    }
    feeler.direction = unit_error3(world, i3_over_positive(way, limit));
    if (world->choice[CT_OFFSET] == CT_OFFSET_MITSUBA)
      limit = i_mul(limit, i_sub(i_from(1), i_from(SET_MITSUBA_SHADOW)));
  }
  if (!light_counts) return find_blocker(s, &feeler, j, NULL);
  if (i_not_positive(limit)) return SHADOW_NONE; /* the light is within epsilon of the hit */
  shadow_answer answer = find_blocker(s, &feeler, j, &limit);
  return answer == SHADOW_SURE && !i_is_positive(limit) ? SHADOW_POSSIBLE : answer;
}

/* max(0, r.wo)^eta */
static IV highlight_of(STATE *s, const HIT *hit, IV cosine, IV view, IV l_dot_wo, double eta) {
  IV x = i_sub(i_mul(i_add(cosine, cosine), view), l_dot_wo);
  (void)s, (void)hit;
  if (i_not_positive(x)) return i_from(0);
  if (s->world->kappa > 0) x = i_widen(x, b_from(3 * s->world->kappa));
  return set_power(x, eta);
}

static IV3 lights_at(STATE *s, const RAY *ray, const HIT *hit) {
  const WORLD *world = s->world;
  const ct_scene_view *view = world->view;
  const double *m = view->material + hit->object * CT_MATERIAL_COLUMNS;
  int is_diffuse = (world->effects & CT_DIFFUSE) && m[CT_KD] > 0;
  int is_specular = (world->effects & CT_SPECULAR) && m[CT_KS] > 0;
  IV3 sum = i3_zero(), n = hit->normal, wo = hit->wo;
  if (!is_diffuse && !is_specular) return sum;
  if (view->kind[hit->object] == CT_PLANE && world->choice[CT_PLANE_NORMAL] == CT_PLANE_NORMAL_RAW)
    n = i3_from(view->geometry + hit->object * CT_GEOMETRY_COLUMNS + 3);
  if (world->choice[CT_LIGHTING_NORMAL] == CT_LIGHTING_NORMAL_FACING) {
    if (i_not_positive(hit->cosine))
      n = i3_neg(n);
    else if (!i_is_positive(hit->cosine) &&
             decide(s, 2, CT_DECISION_SIDE, ray->depth, (int64_t)hit->object))
      n = i3_neg(n);
  }
  if (world->choice[CT_VIEW] == CT_VIEW_EYE && !ray->primary) {
    IV3 to_eye = i3_sub(i3_from(view->eye), hit->point);
    IV length = i3_length(to_eye);
    if (!i_is_positive(length)) {
      give_up(s, CT_SET_PRECISION, ray->depth, (int64_t)hit->object);
      return sum;
    }
    wo = i3_over_positive(to_eye, length);
  }
  IV towards_view = i3_dot(n, wo), ks = i_from(m[CT_KS]);
  for (size_t j = 0; j < view->n_lights && s->status == CT_SET_DECIDED; j++) {
    IV3 light = i3_from(view->lights + j * CT_LIGHT_COLUMNS + 3);
    IV3 way = i3_sub(light, hit->point);
    IV distance = i3_length(way);
    if (!i_is_positive(distance)) {
      give_up(s, CT_SET_PRECISION, ray->depth, (int64_t)hit->object);
      return sum;
    }
    IV3 l = unit_error3(world, i3_over_positive(way, distance));
    IV cosine = i3_dot(n, l), shine = i_from(0);
    int may_shine = is_specular;
    if (may_shine && world->choice[CT_SPECULAR_GATE] == CT_SPECULAR_GATE_LIT) {
      if (i_not_positive(cosine))
        may_shine = 0;
      else if (!i_is_positive(cosine))
        may_shine = !decide(s, 2, CT_DECISION_GATE, ray->depth, (int64_t)hit->object);
    }
    if (may_shine) shine = highlight_of(s, hit, cosine, towards_view, i3_dot(l, wo), m[CT_ETA]);
    if ((!is_diffuse || i_not_positive(cosine)) && i_is_zero(shine)) continue;
    IV3 c = i3_zero();
    if (is_diffuse) c = i3_mul(i3_scale(i_floor_zero(cosine), world->diffuse[hit->object]),
                               world->light[j]);
    c = i3_add(c, i3_scale(i_mul(ks, shine), world->light[j]));
    if (world->effects & CT_SHADOWS) {
      shadow_answer answer = shadow_of(s, ray, hit, j, light, l, distance);
      if (answer == SHADOW_SURE) continue;
      if (answer == SHADOW_POSSIBLE) {
        /* Rounding leaves most shadows open; their outcomes would multiply without end. */
        if (world->kappa > 0 || !b_less(b_from(SET_NEGLIGIBLE), i3_magnitude(c)))
          c = i3_hull(c, i3_zero());
        else if (decide(s, 2, CT_DECISION_SHADOW, ray->depth, (int64_t)hit->object))
          continue;
      }
    }
    sum = i3_add(sum, c);
  }
  return sum;
}

/* ---- Secondary rays ---- */

typedef struct SET_FN(scatter) {
  IV kr, kt;
  IV3 mirrored, refracted;
  const ct_medium *medium;
} SCATTER;

static IV seen_index(const WORLD *world, const RAY *ray, size_t object, int inside,
                     ct_medium *entered, const ct_medium **medium) {
  double n = world->view->material[object * CT_MATERIAL_COLUMNS + CT_N];
  IV one = i_from(1), own = i_from(n);
  if (world->choice[CT_NESTING] == CT_NESTING_TRACKED) {
    *entered = (ct_medium){ray->medium, object, inside ? -1 : 1};
    *medium = entered;
    return i_over_positive(i_from(ct_medium_index(world->view, entered)),
                           i_from(ct_medium_index(world->view, ray->medium)));
  }
  int side = world->choice[CT_SIDE];
  int inverse = side == CT_SIDE_INVERTED ? !inside : side == CT_SIDE_ONE_WAY ? 0 : inside;
  return inverse ? i_over_positive(one, own) : own;
}

static SCATTER scatter_of(STATE *s, const RAY *ray, const HIT *hit, ct_medium *entered) {
  const WORLD *world = s->world;
  const double *m = world->view->material + hit->object * CT_MATERIAL_COLUMNS;
  IV zero = i_from(0), one = i_from(1), cosine = hit->cosine;
  SCATTER out = {.kr = zero, .kt = zero, .medium = ray->medium};
  int tir = world->choice[CT_TIR];
  int bends = m[CT_KT] > 0 || (tir == CT_TIR_ALWAYS && m[CT_N] > 0);
  int inside = i_not_positive(cosine);
  /* Reflection is the same from either side, so the side matters only to glass. */
  out.mirrored = i3_sub(i3_scale(i_add(cosine, cosine), hit->normal), hit->wo);
  if (world->kappa > 0) out.mirrored = unit_error3(world, out.mirrored);
  if (bends && !inside && !i_is_positive(cosine))
    inside = decide(s, 2, CT_DECISION_SIDE, ray->depth, (int64_t)hit->object);
  IV3 facing = inside ? i3_neg(hit->normal) : hit->normal;
  if (inside) cosine = i_neg(cosine);
  cosine = i_floor_zero(cosine);
  int reflects = m[CT_KR] > 0 && (world->effects & CT_REFLECTION);
  if (inside && m[CT_KT] > 0 && world->choice[CT_INNER_REFLECTION] == CT_INNER_REFLECTION_OFF)
    reflects = 0;
  if (reflects) out.kr = i_from(m[CT_KR]);
  if (!bends) return out;

  IV index = seen_index(world, ray, hit->object, inside, entered, &out.medium);
  IV ratio = i_over_positive(one, index);
  IV sine2 = i_mul(i_sub(one, cosine), i_add(one, cosine));
  IV delta = i_sub(one, i_mul(i_square(ratio), i_floor_zero(sine2)));
  if (world->kappa > 0)
    delta = i_widen(delta, error_of(world, b_add(b_from(4), i_square(ratio).hi)));
  int total = i_is_negative(delta);
  if (!total && !i_not_negative(delta))
    total = decide(s, 2, CT_DECISION_TOTAL, ray->depth, (int64_t)hit->object);
  if (!total) {
    IV along = i_sub(i_sqrt(delta), i_mul(ratio, cosine));
    out.refracted = i3_sub(i3_neg(i3_scale(ratio, hit->wo)), i3_scale(along, facing));
    if (world->kappa > 0) out.refracted = unit_error3(world, out.refracted);
    if (world->effects & CT_REFRACTION) out.kt = i_from(m[CT_KT]);
    return out;
  }
  if (!(world->effects & CT_TOTAL_REFLECTION)) return out;
  if (tir == CT_TIR_ADD) out.kr = i_add(out.kr, i_from(m[CT_KT]));
  if (tir == CT_TIR_PLUS_ONE) out.kr = i_add(out.kr, one);
  if (tir == CT_TIR_REPLACE || tir == CT_TIR_ALWAYS || (tir == CT_TIR_NEEDS_KR && m[CT_KR] > 0))
    out.kr = one;
  return out;
}

static IV3 follow(STATE *s, const RAY *ray, const HIT *hit, IV3 direction,
                  const ct_medium *medium) {
  const WORLD *world = s->world;
  if (ray->depth >= world->frame->max_depth)
    return world->choice[CT_EXHAUSTED] == CT_EXHAUSTED_BACKGROUND ? world->background : i3_zero();
  RAY next = {offset_point(world, hit, direction, 0), direction, ray->depth + 1, 0, medium};
  return SET_FN(trace)(s, &next);
}

/* ---- One set of rays ---- */

static IV limit_channel(const WORLD *world, IV a) {
  BOUND one = b_from(1);
  if (world->choice[CT_RECURSION] != CT_RECURSION_CLAMP) return a;
  return iv(b_max(a.nlo, b_neg(one)), b_min(a.hi, one));
}

static IV3 limit_color(const WORLD *world, IV3 c) {
  if (world->choice[CT_RECURSION] == CT_RECURSION_SCALE) {
    BOUND one = b_from(1);
    BOUND least = b_max(b_max(b_neg(c.x.nlo), b_neg(c.y.nlo)), b_neg(c.z.nlo));
    IV largest = iv(b_neg(b_max(least, one)), b_max(b_max(b_max(c.x.hi, c.y.hi), c.z.hi), one));
    return i3_over_positive(c, largest);
  }
  return i3(limit_channel(world, c.x), limit_channel(world, c.y), limit_channel(world, c.z));
}

/* What a ray returns, under the recursion reading and with the error under test. */
static IV3 returned(const WORLD *world, IV3 c) {
  if (world->kappa > 0) c = i3_widen(c, error_of(world, i3_magnitude(c)));
  return limit_color(world, c);
}

static IV3 SET_FN(trace)(STATE *s, const RAY *ray) {
  const WORLD *world = s->world;
  const ct_scene_view *view = world->view;
  if (s->status != CT_SET_DECIDED) return i3_zero();
  if (++s->n_rays > s->limits->n_rays || ray->depth > CT_MAX_TREE_DEPTH ||
      atomic_load_explicit(s->limits->stop, memory_order_relaxed)) {
    give_up(s, CT_SET_BUDGET, ray->depth, -1);
    return i3_zero();
  }
  OUTCOME outcome = nearest_outcome(s, ray);
  if (s->status != CT_SET_DECIDED) return i3_zero();
  if (outcome.object < 0) {
    int shows = ray->primary || world->choice[CT_MISS] == CT_MISS_BACKGROUND;
    return returned(world, shows ? world->background : i3_zero());
  }
  HIT hit = {.object = (size_t)outcome.object, .wo = i3_neg(ray->direction)};
  const double *g = view->geometry + hit.object * CT_GEOMETRY_COLUMNS;
  hit.point = i3_along(ray->origin, outcome.t, ray->direction);
  if (world->kappa > 0)
    hit.point = i3_widen(hit.point, error_of(world, b_add(i3_magnitude(ray->origin),
                                                          i3_magnitude(hit.point))));
  if (view->kind[hit.object] == CT_PLANE)
    hit.normal = world->plane_normal[world->frame->plane_slot[hit.object]];
  else
    hit.normal = i3_over_positive(i3_sub(hit.point, i3_from(g)), i_from(g[3]));
  hit.cosine = i3_dot(hit.normal, hit.wo);

  IV3 sum = world->base[hit.object];
  if (view->delivery == 1) return returned(world, sum);
  sum = i3_add(sum, lights_at(s, ray, &hit));
  if (view->delivery == 3 && s->status == CT_SET_DECIDED) {
    ct_medium entered;
    SCATTER scatter = scatter_of(s, ray, &hit, &entered);
    if (world->choice[CT_MIX] == CT_MIX_CONVEX)
      sum = i3_scale(i_sub(i_sub(i_from(1), scatter.kr), scatter.kt), sum);
    if (i_is_positive(scatter.kr))
      sum = i3_add(sum, i3_scale(scatter.kr, follow(s, ray, &hit, scatter.mirrored, ray->medium)));
    if (i_is_positive(scatter.kt))
      sum = i3_add(sum, i3_scale(scatter.kt, follow(s, ray, &hit, scatter.refracted,
                                                    scatter.medium)));
  }
  return returned(world, sum);
}
