/* Where sets of rays leave a surface, what may stand before a light, and the light of the
 * specification's 3.2. Written anew from the specification, not from the point kernel: r.wo is
 * 2(n.l)(n.wo) - l.wo.
 */

typedef struct SET_FN(hit) {
  size_t object;
  IV3 point, normal, wo;
  IV cosine; /* normal.wo */
} HIT;

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

/* Whether light j is blocked: SHADOW_POSSIBLE where that is open. */
static shadow_answer shadow_of(STATE *s, const RAY *ray, const HIT *hit, size_t j, IV3 light,
                               IV3 to_light, IV distance) {
  const WORLD *world = s->world;
  int light_counts = world->choice[CT_SHADOW_DISTANCE] == CT_SHADOW_DISTANCE_LIGHT;
  RAY feeler = {offset_point(world, hit, to_light, 1), to_light, ray->depth, 0, NULL};
  IV reach = i_sub(distance, world->epsilon);
  if (world->choice[CT_OFFSET] != CT_OFFSET_DIRECTION) {
    IV3 way = i3_sub(light, feeler.origin);
    reach = i3_length(way);
    if (!i_is_positive(reach)) {
      give_up(s, CT_SET_PRECISION, ray->depth, (int64_t)hit->object);
      return SHADOW_NONE;
    }
    feeler.direction = unit_error3(world, i3_over_positive(way, reach));
  }
  IV limit = i_sub(reach, i_from(world->frame->options->light_min));
  if (world->choice[CT_OFFSET] == CT_OFFSET_MITSUBA) {
    IV shortened = i_mul(reach, i_sub(i_from(1), i_from(SET_MITSUBA_SHADOW)));
    limit = iv(b_max(limit.nlo, shortened.nlo), b_min(limit.hi, shortened.hi)); /* the lesser */
  }
  if (!light_counts) return find_blocker(s, &feeler, j, NULL, NULL);
  if (i_not_positive(limit)) return SHADOW_NONE; /* the light is too near the hit */
  shadow_answer answer = find_blocker(s, &feeler, j, &reach, &limit);
  return answer == SHADOW_SURE && !i_is_positive(limit) ? SHADOW_POSSIBLE : answer;
}

/* max(0, r.wo)^eta */
static IV highlight_of(const WORLD *world, IV cosine, IV view, IV l_dot_wo, double eta) {
  IV x = i_sub(i_mul(i_add(cosine, cosine), view), l_dot_wo);
  if (i_not_positive(x)) return i_from(0);
  if (world->kappa > 0) x = i_widen(x, b_from(3 * world->kappa));
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
    if (may_shine) shine = highlight_of(world, cosine, towards_view, i3_dot(l, wo), m[CT_ETA]);
    if ((!is_diffuse || i_not_positive(cosine)) && i_is_zero(shine)) continue;
    IV3 c = i3_zero();
    if (is_diffuse) c = i3_mul(i3_scale(i_floor_zero(cosine), diffuse_of(world, hit->object)),
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
