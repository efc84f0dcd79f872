/* The hooks of hooks.inc.h: one record a ray, written as the kernel goes. */

static ct_recorder *recorder_of(ct_pixel *pixel) { return (ct_recorder *)pixel; }

/* The record of the ray at whose hit the kernel is. */
static ct_ray_record *open_record(ct_recorder *r) { return ct_recorder_at(r, r->open.index); }

static ct_ray_record *new_record(ct_recorder *r, ct_ray_kind kind, int64_t depth, VEC origin,
                                 VEC direction) {
  ct_ray_record *record = ct_recorder_at(r, r->n_rays++);
  *record = (ct_ray_record){.kind = (int32_t)kind, .parent = r->open.index, .depth = depth,
                            .object = -1, .light = -1, .margin_object = -1,
                            .t_world = (double)INFINITY, .margin = (double)INFINITY,
                            .clearance = (double)INFINITY};
  v_store(origin, record->origin);
  v_store(direction, record->direction);
  return record;
}

static ct_open_ray record_ray(const WORLD *world, ct_pixel *pixel, const RAY *ray,
                              const HIT *hit) {
  ct_recorder *r = recorder_of(pixel);
  const ct_open_ray parent = r->open;
  ct_ray_record *record = new_record(r, r->next_kind, ray->depth, ray->origin, ray->direction);
  record->weight = parent.weight * r->next_factor;
  record->object = hit->object;
  consider_nearest(world, ray, hit, parent.object, record);
  if (hit->object >= 0) {
    record->t_world = hit->t;
    v_store(hit->point, record->point);
    v_store(hit->normal, record->normal);
    double cosine = -v_dot(hit->normal, ray->direction);
    record->inside = !(cosine > 0);
    if (world->view->delivery > 1 &&
        world->choice[CT_LIGHTING_NORMAL] == CT_LIGHTING_NORMAL_FACING)
      consider(record, fabs(cosine), CT_DECISION_SIDE, hit->object);
  }
  r->open = (ct_open_ray){r->n_rays - 1, hit->object, record->weight};
  return parent;
}

static VEC record_return(ct_pixel *pixel, const ct_open_ray *parent, const SPLIT *split,
                         VEC color) {
  ct_recorder *r = recorder_of(pixel);
  ct_ray_record *record = open_record(r);
  v_store(split->base, record->base);
  v_store(split->diffuse, record->diffuse);
  v_store(split->specular, record->specular);
  v_store(color, record->color);
  r->open = *parent;
  return color;
}

static void record_light(const WORLD *world, ct_pixel *pixel, const HIT *hit, size_t j,
                         REAL cosine, int lit, VEC diffuse, int is_specular, REAL shine) {
  ct_recorder *r = recorder_of(pixel);
  const double *m = world->view->material + (size_t)hit->object * CT_MATERIAL_COLUMNS;
  VEC c = v_over(v_load(world->view->lights + j * CT_LIGHT_COLUMNS), 255);
  v_store(lit ? v_mul(v_scale(cosine, diffuse), c) : v_zero(), r->diffuse);
  v_store(shine > 0 ? v_scale(m[CT_KS] * shine, c) : v_zero(), r->specular);
  if (is_specular && world->choice[CT_SPECULAR_GATE] == CT_SPECULAR_GATE_LIT)
    consider(open_record(r), fabs(cosine), CT_DECISION_GATE, hit->object);
}

static void record_feeler(const WORLD *world, ct_pixel *pixel, const RAY *ray, const HIT *hit,
                          size_t j, VEC origin, VEC direction, REAL limit) {
  ct_recorder *r = recorder_of(pixel);
  ct_ray_record *record = new_record(r, CT_RAY_SHADOW, ray->depth, origin, direction);
  VEC light = v_load(world->view->lights + j * CT_LIGHT_COLUMNS + 3);
  record->light = (int64_t)j;
  record->weight = r->open.weight;
  record->light_distance = v_length(v_sub(light, hit->point));
  consider_shadow(world, j, origin, direction, limit, hit->object, record);
  for (int k = 0; k < 3; k++) {
    record->diffuse[k] = r->diffuse[k];
    record->specular[k] = r->specular[k];
    record->color[k] = record->object < 0 ? r->diffuse[k] + r->specular[k] : 0;
  }
  if (record->object < 0) return;
  size_t i = (size_t)record->object;
  record->t_world = object_nearest(world, i, origin, direction, 0, world->shadow_min);
  VEC point = v_along(origin, record->t_world, direction);
  v_store(point, record->point);
  v_store(object_normal(world, i, point), record->normal);
}

static void record_scatter(const WORLD *world, ct_pixel *pixel, const RAY *ray, const HIT *hit,
                           const SCATTER *s) {
  ct_recorder *r = recorder_of(pixel);
  ct_ray_record *record = open_record(r);
  record->total = s->total;
  consider_total(world, ray, hit, s->inside, record);
  if (world->choice[CT_MIX] != CT_MIX_CONVEX) return;
  /* The rays since this one are those to its lights, whose terms are scaled by now. */
  for (int64_t i = r->open.index + 1; i < r->n_rays; i++) {
    ct_ray_record *feeler = ct_recorder_at(r, i);
    for (int k = 0; k < 3; k++) {
      feeler->diffuse[k] *= 1 - s->kr - s->kt;
      feeler->specular[k] *= 1 - s->kr - s->kt;
      feeler->color[k] *= 1 - s->kr - s->kt;
    }
  }
}

static void record_branch(ct_pixel *pixel, ct_ray_kind kind, REAL factor) {
  ct_recorder *r = recorder_of(pixel);
  r->next_kind = kind;
  r->next_factor = factor;
}

static void record_unsent(ct_pixel *pixel, VEC color) {
  ct_recorder *r = recorder_of(pixel);
  double *unsent = open_record(r)->unsent;
  v_store(v_along(v_load(unsent), r->next_factor, color), unsent);
}
