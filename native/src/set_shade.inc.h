/* Secondary rays and recursion over sets of rays (specification 4.1, 4.2).
 *
 * Written anew from the specification, not from the point kernel: directions are never normalised
 * again, as they have length 1 in real arithmetic.
 */

static IV3 SET_FN(trace)(STATE *s, const RAY *ray);

/* ---- Secondary rays ---- */

typedef struct SET_FN(scatter) {
  IV kr, kt;
  IV3 mirrored, refracted;
  const ct_medium *medium;
  int passes; /* refraction is no bounce */
} SCATTER;

static IV seen_index(const WORLD *world, const RAY *ray, size_t object, int inside,
                     ct_medium *entered, const ct_medium **medium) {
  double n = world->view->material[object * CT_MATERIAL_COLUMNS + CT_N];
  IV one = i_from(1), own = i_from(n);
  int nesting = world->choice[CT_NESTING];
  if (nesting != CT_NESTING_RELATIVE) {
    *entered = ct_medium_crossed(nesting, ray->medium, object, inside);
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
  if (out.medium == entered &&
      ct_medium_passes(world->view, world->choice[CT_NESTING], entered)) {
    out.passes = 1;
    out.refracted = ray->direction;
    if (world->effects & CT_REFRACTION) out.kt = i_from(m[CT_KT]);
    return out;
  }
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
                  const ct_medium *medium, int passes) {
  const WORLD *world = s->world;
  if (ray->depth >= world->frame->max_depth)
    return world->choice[CT_EXHAUSTED] == CT_EXHAUSTED_BACKGROUND ? world->background : i3_zero();
  RAY next = {offset_point(world, hit, direction, 0), direction, passes ? ray->depth : ray->depth + 1, 0, medium};
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

  IV3 sum = base_of(world, (size_t)hit.object);
  if (view->delivery == 1) return returned(world, sum);
  sum = i3_add(sum, lights_at(s, ray, &hit));
  if (view->delivery == 3 && s->status == CT_SET_DECIDED) {
    ct_medium entered;
    SCATTER scatter = scatter_of(s, ray, &hit, &entered);
    if (world->choice[CT_MIX] == CT_MIX_CONVEX)
      sum = i3_scale(i_sub(i_sub(i_from(1), scatter.kr), scatter.kt), sum);
    if (i_is_positive(scatter.kr))
      sum = i3_add(sum, i3_scale(scatter.kr, follow(s, ray, &hit, scatter.mirrored, ray->medium, 0)));
    if (i_is_positive(scatter.kt))
      sum = i3_add(sum, i3_scale(scatter.kt, follow(s, ray, &hit, scatter.refracted,
                                                    scatter.medium, scatter.passes)));
  }
  return returned(world, sum);
}
