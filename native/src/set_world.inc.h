/* The world of the set-valued kernel: what is the same for every pixel, as intervals. */

typedef struct SET_FN(world) {
  const ct_frame *frame;
  const ct_scene_view *view;
  const int *choice;
  unsigned effects;
  IV3 u, v, w; /* specification 2.3 */
  IV3 *plane_normal;
  IV3 *base, *diffuse; /* of each object: ka*cd*ca and kd*cd; the flat colour in delivery 1; or NULL */
  IV3 *light;          /* colours of the lights, 0..1 */
  IV3 background;
  IV epsilon;
  uint8_t *is_twin; /* objects textually equal to an earlier one: the tie is decided */
  double kappa;
} WORLD;

static IV color_of(double byte) { return i_over_positive(i_from(byte), i_from(255)); }

static IV3 color3(const double *bytes) {
  return i3(color_of(bytes[0]), color_of(bytes[1]), color_of(bytes[2]));
}

static void set_camera(WORLD *world) {
  const ct_scene_view *v = world->view;
  IV3 w = i3_sub(i3_from(v->eye), i3_from(v->target));
  IV3 u = i3_cross(i3_from(v->up), w), up = i3_cross(w, u);
  world->w = i3_over_positive(w, i3_length(w));
  world->u = i3_over_positive(u, i3_length(u));
  world->v = i3_over_positive(up, i3_length(up)); /* w x u has the direction of (w x u)/|...| */
}

static int same_surface(const ct_scene_view *v, size_t i, size_t j) {
  return v->kind[i] == v->kind[j] && memcmp(v->geometry + i * CT_GEOMETRY_COLUMNS,
                                            v->geometry + j * CT_GEOMETRY_COLUMNS,
                                            CT_GEOMETRY_COLUMNS * sizeof(double)) == 0;
}

/* Quadratic, so only where it is cheap; elsewhere a tie stays undecided, which is safe. */
static void mark_twins(WORLD *world) {
  size_t n = world->view->n_objects;
  if (n > 4096) return;
  for (size_t i = 1; i < n; i++)
    for (size_t j = 0; j < i && !world->is_twin[i]; j++)
      world->is_twin[i] = (uint8_t)same_surface(world->view, i, j);
}

/* What object i shows without a lamp, and what it does with a lamp's light. */
static IV3 new_base(const WORLD *world, size_t i) {
  const ct_scene_view *v = world->view;
  const double *m = v->material + i * CT_MATERIAL_COLUMNS;
  IV3 color = color3(v->color + 3 * i);
  if (v->delivery == 1) return (world->effects & CT_FLAT) != 0 ? color : i3_zero();
  if (!(world->effects & CT_AMBIENT) || !(m[CT_KA] > 0)) return i3_zero();
  return i3_mul(i3_scale(i_from(m[CT_KA]), color), color3(v->ambient));
}

static IV3 new_diffuse(const WORLD *world, size_t i) {
  double kd = world->view->material[i * CT_MATERIAL_COLUMNS + CT_KD];
  return i3_scale(i_from(kd), color3(world->view->color + 3 * i));
}

/* Of many objects they are worked out when asked for, as they take up to 200 bytes each. */
static IV3 base_of(const WORLD *world, size_t i) {
  return world->base ? world->base[i] : new_base(world, i);
}

static IV3 diffuse_of(const WORLD *world, size_t i) {
  return world->diffuse ? world->diffuse[i] : new_diffuse(world, i);
}

static ct_status set_materials(WORLD *world) {
  const ct_scene_view *v = world->view;
  for (size_t j = 0; j < v->n_lights; j++)
    world->light[j] = color3(v->lights + j * CT_LIGHT_COLUMNS);
  world->background = color3(v->background);
  if (world->frame->bvh) return CT_OK;
  world->base = malloc((v->n_objects + 1) * sizeof *world->base);
  world->diffuse = malloc((v->n_objects + 1) * sizeof *world->diffuse);
  if (!world->base || !world->diffuse) return CT_ERR_MEMORY;
  for (size_t i = 0; i < v->n_objects; i++) {
    world->base[i] = new_base(world, i);
    world->diffuse[i] = new_diffuse(world, i);
  }
  return CT_OK;
}

static void SET_FN(close)(void *opaque) {
  WORLD *world = opaque;
  free(world->plane_normal);
  free(world->base);
  free(world->diffuse);
  free(world->light);
  free(world->is_twin);
  free(world);
}

/* Called with the mode of the type set (certify.c). */
static ct_status SET_FN(open)(const ct_frame *frame, double kappa, void **out) {
  const ct_scene_view *v = &frame->view;
  WORLD *world = calloc(1, sizeof *world);
  if (!world) return CT_ERR_MEMORY;
  *world = (WORLD){.frame = frame, .view = v, .choice = frame->options->choice,
                   .effects = frame->options->effects, .kappa = kappa};
  world->plane_normal = malloc((frame->n_planes + 1) * sizeof *world->plane_normal);
  world->light = malloc((v->n_lights + 1) * sizeof *world->light);
  world->is_twin = calloc(v->n_objects + 1, 1);
  if (!world->plane_normal || !world->light || !world->is_twin || set_materials(world)) {
    SET_FN(close)(world);
    return CT_ERR_MEMORY;
  }
  set_camera(world);
  mark_twins(world);
  for (size_t i = 0; i < v->n_objects; i++) {
    if (v->kind[i] != CT_PLANE) continue;
    IV3 n = i3_from(v->geometry + i * CT_GEOMETRY_COLUMNS + 3);
    world->plane_normal[frame->plane_slot[i]] = i3_over_positive(n, i3_length(n));
  }
  IV epsilon = i_from(frame->options->epsilon);
  world->epsilon = frame->options->choice[CT_EPSILON_TWICE] ? i_mul(i_from(2), epsilon) : epsilon;
  *out = world;
  return CT_OK;
}
