/* A frame as the stream reads it: what the scalar kernel works out at every hit from an object's
 * numbers alone, worked out once, by the same operations. */

/* What of an object a ray meets. */
typedef struct FN(shape) {
  VEC at, normal; /* centre; or point and unit normal of a plane */
  REAL r2;        /* radius squared */
  int is_plane, eye_on;
} FN(shape);
#define SHAPE FN(shape)

/* What its surface does with light. */
typedef struct FN(surface) {
  VEC base, diffuse; /* flat or ambient term; kd * colour */
  REAL ks, kr, kt;
  REAL ratio[2]; /* of refraction: from outside, from inside */
  REAL nothing_below, least_above; /* powers that underflow: see stream_light.inc.h */
  double eta;
  int is_diffuse, is_specular, is_squared, is_clear, has_kr, has_kt;
} FN(surface);
#define SURFACE FN(surface)

typedef struct FN(lamp) {
  VEC at, color;
  int is_on_a_surface;
} FN(lamp);
#define LAMP FN(lamp)

typedef struct FN(stage) {
  WORLD *world;
  const ct_bvh *bvh; /* NULL: every object is asked */
  SHAPE *shape;     /* of every object; with a tree, of those apart from it */
  SURFACE *surface; /* of every object */
  LAMP *lamp;
  COLUMNS center; /* of every sphere, side by side; without a tree alone */
  REAL *radius;   /* of every sphere, infinite for a plane; without a tree alone */
  /* With a tree: four numbers a sphere, and the n of a leaf together, as what one miss of a cache
   * brings: n x, n y, n z, n radii. */
  REAL *leaf;
  uint64_t *all;  /* a bit for every object; without a tree alone */
  VEC background, missed; /* by a primary ray, by any other */
  VEC exhausted;
  int ends_lit; /* exhausted is not black */
  size_t n_objects, n_lamps;
  size_t n_words; /* of a bit for every object; 0 with a tree */
  int has_lights, has_scatter;
} FN(stage);
#define STAGE FN(stage)

static void read_surface(const WORLD *world, size_t i, SURFACE *s) {
  const ct_scene_view *view = world->view;
  const double *m = view->material + i * CT_MATERIAL_COLUMNS;
  REAL zero = from_double(0), one = from_double(1), byte = from_double(255);
  VEC color = v_over(v_load(view->color + 3 * i), byte);
  *s = (SURFACE){.eta = m[CT_ETA], .base = v_zero(), .kr = zero, .kt = zero};
  if (view->delivery == 1) {
    if (world->effects & CT_FLAT) s->base = color;
    return;
  }
  if ((world->effects & CT_AMBIENT) && m[CT_KA] > 0)
    s->base = v_mul(v_scale(from_double(m[CT_KA]), color), v_over(v_load(view->ambient), byte));
  s->is_diffuse = (world->effects & CT_DIFFUSE) && m[CT_KD] > 0;
  s->is_specular = (world->effects & CT_SPECULAR) && m[CT_KS] > 0;
  s->diffuse = v_scale(from_double(m[CT_KD]), color);
  s->ks = from_double(m[CT_KS]);
  s->is_squared = m[CT_ETA] <= GREATEST_SQUARED && m[CT_ETA] == floor(m[CT_ETA]);
  double underflow = exp(REAL_LEAST_EXPONENT / m[CT_ETA]);
  s->nothing_below = from_double(0.98 * underflow);
  s->least_above = from_double(1.02 * underflow);
  if (m[CT_KR] > 0 && (world->effects & CT_REFLECTION)) s->kr = from_double(m[CT_KR]);
  s->is_clear = m[CT_KT] > 0;
  if (s->is_clear && (world->effects & CT_REFRACTION)) s->kt = from_double(m[CT_KT]);
  s->has_kr = less(zero, s->kr);
  s->has_kt = less(zero, s->kt);
  for (int inside = 0; inside < 2; inside++) {
    const ct_medium *unused;
    INDEX index = seen_index(world, NULL, i, inside, NULL, &unused);
    s->ratio[inside] = quo(one, quo(index.over, index.under));
  }
}

static void read_shape(const WORLD *world, size_t i, SHAPE *s) {
  const double *g = world->view->geometry + i * CT_GEOMETRY_COLUMNS;
  REAL radius = from_double(g[3]);
  s->at = v_load(g);
  s->eye_on = world->frame->eye_on[i];
  s->is_plane = world->view->kind[i] == CT_PLANE;
  s->r2 = mul(radius, radius);
  s->normal = s->is_plane ? world->plane_normal[world->frame->plane_slot[i]] : v_zero();
}

/* The spheres of the tree, leaf by leaf. Room for a vector beyond the last. */
static int read_leaves(STAGE *stage) {
  const ct_bvh *bvh = stage->bvh;
  stage->leaf = calloc(4 * bvh->n_objects + N_LANES, sizeof *stage->leaf);
  if (!stage->leaf) return 0;
  for (size_t node = 0; node < bvh->n_nodes; node++)
    for (int j = 0; j < CT_BVH_WIDTH; j++) {
      uint32_t child = bvh->nodes[node].child[j];
      if (!(child & CT_BVH_IS_LEAF)) continue;
      size_t first;
      unsigned n;
      ct_walk_leaf(child, &first, &n);
      for (size_t k = 0; k < n; k++) {
        const double *g =
            stage->world->view->geometry + bvh->object[first + k] * CT_GEOMETRY_COLUMNS;
        for (size_t c = 0; c < 4; c++) stage->leaf[4 * first + c * n + k] = from_double(g[c]);
      }
    }
  return 1;
}

/* The spheres side by side, in whole vectors. */
static int read_columns(STAGE *stage) {
  size_t room = stage->n_objects + 2 * N_LANES;
  REAL *columns = calloc(4 * room, sizeof *columns);
  stage->all = malloc((stage->n_words + 1) * sizeof *stage->all);
  if (!columns || !stage->all) {
    free(columns);
    return 0;
  }
  for (size_t i = 0; i < stage->n_words * 64; i += 64) {
    size_t n = stage->n_objects - i;
    stage->all[i / 64] = n >= 64 ? ~UINT64_C(0) : (UINT64_C(1) << n) - 1;
  }
  stage->center = (COLUMNS){columns, columns + room, columns + 2 * room};
  stage->radius = columns + 3 * room;
  for (size_t i = 0; i < stage->n_objects; i++) {
    const double *g = stage->world->view->geometry + i * CT_GEOMETRY_COLUMNS;
    int is_plane = stage->world->view->kind[i] == CT_PLANE;
    stage->center.x[i] = from_double(g[0]);
    stage->center.y[i] = from_double(g[1]);
    stage->center.z[i] = from_double(g[2]);
    stage->radius[i] = from_double(is_plane ? (double)INFINITY : g[3]);
  }
  return 1;
}

/* What of the objects a ray meets. */
static void read_shapes(STAGE *stage) {
  const ct_bvh *bvh = stage->bvh;
  size_t n = bvh ? bvh->n_apart : stage->n_objects;
  for (size_t k = 0; k < n; k++)
    read_shape(stage->world, bvh ? bvh->apart[k] : k, stage->shape + k);
}

static void read_lamp(const WORLD *world, size_t j, LAMP *lamp) {
  const double *light = world->view->lights + j * CT_LIGHT_COLUMNS;
  lamp->at = v_load(light + 3);
  lamp->color = v_over(v_load(light), from_double(255));
  lamp->is_on_a_surface = 0;
  for (size_t k = 0; k < world->frame->n_lights_on; k++)
    if (world->frame->lights_on[k].light == j) lamp->is_on_a_surface = 1;
}

static void FN(close_stage)(void *opaque) {
  STAGE *stage = opaque;
  if (!stage) return;
  if (stage->world) FN(close)(stage->world);
  free(stage->shape);
  free(stage->surface);
  free(stage->lamp);
  free(stage->center.x);
  free(stage->leaf);
  free(stage->all);
  free(stage);
}

static ct_status FN(open_stage)(const ct_frame *frame, void **out) {
  STAGE *stage = calloc(1, sizeof *stage);
  if (!stage) return CT_ERR_MEMORY;
  void *world = NULL;
  ct_status status = FN(open)(frame, &world);
  const ct_scene_view *view = &frame->view;
  stage->world = world;
  stage->n_objects = view->n_objects;
  stage->n_lamps = view->n_lights;
  stage->bvh = frame->bvh;
  stage->n_words = stage->bvh ? 0 : (view->n_objects + 63) / 64;
  size_t n_shapes = stage->bvh ? stage->bvh->n_apart : view->n_objects;
  stage->shape = malloc((n_shapes + 1) * sizeof *stage->shape);
  stage->surface = malloc((view->n_objects + 1) * sizeof *stage->surface);
  stage->lamp = malloc((view->n_lights + 1) * sizeof *stage->lamp);
  if (!status && (!stage->shape || !stage->surface || !stage->lamp ||
                  !(stage->bvh ? read_leaves(stage) : read_columns(stage))))
    status = CT_ERR_MEMORY;
  if (status) {
    FN(close_stage)(stage);
    return status;
  }
  read_shapes(stage);
  for (size_t i = 0; i < view->n_objects; i++) read_surface(world, i, stage->surface + i);
  for (size_t j = 0; j < view->n_lights; j++) read_lamp(world, j, stage->lamp + j);
  stage->has_lights = view->delivery > 1;
  stage->has_scatter = view->delivery > 2;
  stage->background = background(world);
  int misses_black = stage->world->choice[CT_MISS] == CT_MISS_BLACK;
  stage->missed = misses_black ? v_zero() : stage->background;
  int ends_black = stage->world->choice[CT_EXHAUSTED] == CT_EXHAUSTED_BLACK;
  stage->exhausted = ends_black ? v_zero() : stage->background;
  stage->ends_lit = !ends_black;
  *out = stage;
  return CT_OK;
}
