/* What a hit does with light along its secondary rays: reflection, refraction, total reflection
 * (specification 4.1, 4.2), under the readings. */

/* What a hit does with light that arrives along its secondary rays. */
typedef struct FN(scatter) {
  VEC mirrored, refracted;
  REAL kr, kt;
  int total, inside, passes; /* passes: refraction is no bounce */
  const ct_medium *medium;
} FN(scatter);
#define SCATTER FN(scatter)

/* The index seen by a ray that crosses into or out of the object, under the readings. */
static INDEX seen_index(const WORLD *world, const RAY *ray, size_t object, int inside,
                       ct_medium *entered, const ct_medium **medium) {
  const double *m = world->view->material + object * CT_MATERIAL_COLUMNS;
  REAL one = from_double(1), n = from_double(m[CT_N]);
  int side = world->choice[CT_SIDE];
  int nesting = world->choice[CT_NESTING];
  if (nesting != CT_NESTING_RELATIVE) {
    *entered = ct_medium_crossed(nesting, ray->medium, object, inside);
    *medium = entered;
    return (INDEX){from_double(ct_medium_index(world->view, *medium)),
                   from_double(ct_medium_index(world->view, ray->medium))};
  }
  int is_inverse = side == CT_SIDE_INVERTED ? !inside : inside && side != CT_SIDE_ONE_WAY;
  return is_inverse ? (INDEX){one, n} : (INDEX){n, one};
}

static SCATTER scatter_at(const WORLD *world, const RAY *ray, const HIT *hit, const double *m,
                          ct_medium *entered) {
  REAL zero = from_double(0), one = from_double(1);
  VEC wo = v_neg(ray->direction);
  REAL cosine = v_dot(hit->normal, wo);
  SCATTER s = {.kr = zero, .kt = zero, .medium = ray->medium};
  s.inside = !less(zero, cosine);
  VEC facing = s.inside ? v_neg(hit->normal) : hit->normal;
  if (s.inside) cosine = neg(cosine);
  s.mirrored = v_sub(v_scale(mul(from_double(2), cosine), facing), wo);

  int tir = world->choice[CT_TIR];
  int reflects = m[CT_KR] > 0 && (world->effects & CT_REFLECTION);
  if (s.inside && m[CT_KT] > 0 && world->choice[CT_INNER_REFLECTION] == CT_INNER_REFLECTION_OFF)
    reflects = 0;
  if (reflects) s.kr = from_double(m[CT_KR]);
  if (!(m[CT_KT] > 0 || (tir == CT_TIR_ALWAYS && m[CT_N] > 0))) return s;

  INDEX index = seen_index(world, ray, (size_t)hit->object, s.inside, entered, &s.medium);
  if (s.medium == entered && ct_medium_passes(world->view, world->choice[CT_NESTING], entered)) {
    s.passes = 1;
    s.refracted = ray->direction;
    if (world->effects & CT_REFRACTION) s.kt = from_double(m[CT_KT]);
    return s;
  }
  if (refract(wo, facing, cosine, index, &s.refracted)) {
    if (world->effects & CT_REFRACTION) s.kt = from_double(m[CT_KT]);
    return s;
  }
  s.total = 1;
  if (!(world->effects & CT_TOTAL_REFLECTION)) return s;
  switch (tir) {
    case CT_TIR_IGNORE: s.total = 0; break;
    case CT_TIR_ADD: s.kr = add(s.kr, from_double(m[CT_KT])); break;
    case CT_TIR_PLUS_ONE: s.kr = add(s.kr, one); break;
    case CT_TIR_NEEDS_KR:
      if (m[CT_KR] > 0)
        s.kr = one;
      else
        s.total = 0;
      break;
    default: s.kr = one;
  }
  return s;
}
