/* How near the decisions of a ray are to falling otherwise (crosstrace.h, ct_ray_record), in plain
 * double: a margin needs two digits. */

#include <string.h>

static void consider(ct_ray_record *record, double margin, ct_certify_decision decision,
                     int64_t object) {
  if (!(margin < record->margin)) return;
  record->margin = margin;
  record->margin_decision = (int32_t)decision;
  record->margin_object = object;
}

static double relative(double part, double whole) { return part > 0 ? part / whole : 0; }

/* How a ray passes a surface. */
typedef struct approach {
  double edge;   /* how near its silhouette; infinity where the ray cannot meet it */
  double edge_t; /* where along the ray that would be */
  double start;  /* how far the ray's start is off the surface, relative to the magnitudes */
  int is_beyond; /* were the start on the other side, the surface would be hit at once */
} approach;

static approach approach_sphere(VEC origin, VEC direction, const double *g, int on_surface) {
  VEC f = v_sub(origin, v_load(g));
  double b = -v_dot(f, direction), r = g[3], f2 = v_dot(f, f);
  if (on_surface) return (approach){fabs(b) / r, 0, (double)INFINITY, 0};
  VEC l = v_along(f, b, direction);
  int is_outside = f2 > r * r, is_ahead = is_outside && b > 0;
  double scale = fmax(r, fmax(v_extent(origin), v_extent(v_load(g))));
  return (approach){is_ahead ? fabs(r * r - v_dot(l, l)) / (r * r) : (double)INFINITY, b,
                    relative(fabs(f2 - r * r) / (sqrt(f2) + r), scale), !is_ahead};
}

static approach approach_plane(VEC origin, VEC direction, const double *g, VEC normal) {
  VEC way = v_sub(v_load(g), origin);
  double slope = v_dot(direction, normal), rise = v_dot(way, normal);
  double scale = fabs(normal.x) * (fabs(origin.x) + fabs(g[0])) +
                 fabs(normal.y) * (fabs(origin.y) + fabs(g[1])) +
                 fabs(normal.z) * (fabs(origin.z) + fabs(g[2]));
  return (approach){fabs(slope), (double)INFINITY, relative(fabs(rise), scale),
                    !(rise * slope > 0)};
}

static approach approach_object(const WORLD *world, size_t i, VEC origin, VEC direction,
                                int primary) {
  const double *g = world->view->geometry + i * CT_GEOMETRY_COLUMNS;
  int on_surface =
      primary && world->frame->eye_on[i] && world->choice[CT_OFFSET] != CT_OFFSET_MITSUBA;
  if (world->view->kind[i] == CT_SPHERE) return approach_sphere(origin, direction, g, on_surface);
  /* Decided once for the frame. */
  if (on_surface) return (approach){(double)INFINITY, (double)INFINITY, (double)INFINITY, 0};
  return approach_plane(origin, direction, g,
                        world->plane_normal[world->frame->plane_slot[i]]);
}

static int is_same_surface(const ct_scene_view *view, size_t a, size_t b) {
  const double *g = view->geometry;
  return view->kind[a] == view->kind[b] &&
         memcmp(g + a * CT_GEOMETRY_COLUMNS, g + b * CT_GEOMETRY_COLUMNS,
                CT_GEOMETRY_COLUMNS * sizeof *g) == 0;
}

/* Which object is hit. `left`: the one that the ray leaves, or -1. */
static void consider_nearest(const WORLD *world, const RAY *ray, const HIT *hit, int64_t left,
                             ct_ray_record *record) {
  double reach = hit->object < 0 ? (double)INFINITY : hit->t;
  for (size_t i = 0; i < world->view->n_objects; i++) {
    int64_t object = (int64_t)i;
    approach a = approach_object(world, i, ray->origin, ray->direction, ray->primary);
    double t = object_nearest(world, i, ray->origin, ray->direction, ray->primary, 0);
    int is_hit = object == hit->object, is_met = t > 0;
    if (is_met && world->has_far && (is_hit || hit->object < 0))
      consider(record, fabs(t - world->far) / world->far, CT_DECISION_NEAREST, object);
    if (is_met && !is_hit && hit->object >= 0 &&
        !is_same_surface(world->view, i, (size_t)hit->object))
      consider(record, (t - reach) / reach, CT_DECISION_NEAREST, object);
    if (is_hit || (!is_met && (hit->object < 0 || a.edge_t < reach)))
      consider(record, a.edge, CT_DECISION_NEAREST, object);
    if (object == left)
      record->clearance = a.start;
    else if (is_hit || a.is_beyond)
      consider(record, a.start, CT_DECISION_NEAREST, object);
  }
}

/* Does object i block a ray to light j, and how near is it to doing otherwise? */
static int blocks(const WORLD *world, size_t i, size_t j, VEC origin, VEC direction, double limit,
                  int64_t left, ct_ray_record *record, double *margin) {
  const double *g = world->view->geometry + i * CT_GEOMETRY_COLUMNS;
  int is_mitsuba = world->choice[CT_OFFSET] == CT_OFFSET_MITSUBA;
  approach a = approach_object(world, i, origin, direction, 0);
  *margin = (double)INFINITY;
  if (limit < (double)INFINITY && !is_mitsuba && ct_light_is_on(world->frame, j, i)) {
    /* Its root at the light is decided; the other one is what may block (light.inc.h). */
    if (world->view->kind[i] == CT_PLANE) return 0;
    VEC light = v_load(world->view->lights + j * CT_LIGHT_COLUMNS + 3);
    double reach = v_length(v_sub(light, origin));
    double other = -2 * v_dot(v_sub(origin, v_load(g)), direction) - reach;
    *margin = fmin(fabs(other - world->shadow_min), fabs(limit - other)) / reach;
    return world->shadow_min < other && other < limit;
  }
  double t = object_nearest(world, i, origin, direction, 0, world->shadow_min);
  int is_met = t > 0 && !(world->has_far && t > world->far);
  int is_blocking = is_met && (t < limit || (is_mitsuba && t <= limit));
  if (is_met && limit < (double)INFINITY) *margin = fabs(t - limit) / limit;
  if (is_blocking || (!is_met && !(a.edge_t >= limit && limit < (double)INFINITY)))
    *margin = fmin(*margin, a.edge);
  if ((int64_t)i == left)
    record->clearance = a.start;
  else if (is_blocking || a.is_beyond)
    *margin = fmin(*margin, a.start);
  return is_blocking;
}

/* Whether anything blocks the light: each thing that nearly does, or the one that surest does. */
static void consider_shadow(const WORLD *world, size_t j, VEC origin, VEC direction, double limit,
                            int64_t left, ct_ray_record *record) {
  double surest = -1;
  int64_t which = -1;
  if (world->choice[CT_SHADOW_DISTANCE] != CT_SHADOW_DISTANCE_LIGHT) limit = (double)INFINITY;
  for (size_t i = 0; i < world->view->n_objects; i++) {
    double margin;
    if (world->choice[CT_GLASS_SHADOW] == CT_GLASS_SHADOW_CLEAR &&
        world->view->material[i * CT_MATERIAL_COLUMNS + CT_KT] > 0)
      continue;
    int is_blocking = blocks(world, i, j, origin, direction, limit, left, record, &margin);
    if (!is_blocking) {
      consider(record, margin, CT_DECISION_SHADOW, (int64_t)i);
      continue;
    }
    if (record->object < 0) record->object = (int64_t)i;
    if (margin > surest) surest = margin, which = (int64_t)i;
  }
  if (which < 0) return;
  record->margin = (double)INFINITY;
  record->margin_decision = CT_DECISION_NONE;
  record->margin_object = -1;
  consider(record, surest, CT_DECISION_SHADOW, which);
}

/* Delta of the specification's 4.2, where refraction is asked for. */
static void consider_total(const WORLD *world, const RAY *ray, const HIT *hit, int inside,
                           ct_ray_record *record) {
  const double *m = world->view->material + (size_t)hit->object * CT_MATERIAL_COLUMNS;
  int tir = world->choice[CT_TIR];
  if (!(m[CT_KT] > 0 || (tir == CT_TIR_ALWAYS && m[CT_N] > 0))) return;
  ct_medium entered;
  const ct_medium *medium = ray->medium;
  INDEX index = seen_index(world, ray, (size_t)hit->object, inside, &entered, &medium);
  double cosine = v_dot(hit->normal, ray->direction), ratio = index.under / index.over;
  double delta = 1 - ratio * ratio * ((1 - cosine) * (1 + cosine));
  consider(record, fabs(cosine), CT_DECISION_SIDE, hit->object);
  consider(record, fabs(delta), CT_DECISION_TOTAL, hit->object);
}
