/* The world of the set-valued kernel: what is the same for every pixel, as intervals. */

typedef struct SET_FN(world) {
  const ct_frame *frame;
  const ct_scene_view *view;
  const int *choice;
  unsigned effects;
  IV3 u, v, w; /* specification 2.3 */
  IV3 *plane_normal;
  IV3 *base, *diffuse; /* of each object: ka*cd*ca and kd*cd; the flat colour in delivery 1 */
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

static void set_materials(WORLD *world) {
  const ct_scene_view *v = world->view;
  IV3 ambient = color3(v->ambient);
  for (size_t i = 0; i < v->n_objects; i++) {
    const double *m = v->material + i * CT_MATERIAL_COLUMNS;
    IV3 color = color3(v->color + 3 * i);
    int has_base = v->delivery == 1 ? (world->effects & CT_FLAT) != 0
                                    : (world->effects & CT_AMBIENT) && m[CT_KA] > 0;
    world->base[i] = v->delivery == 1 ? color
                                      : i3_mul(i3_scale(i_from(m[CT_KA]), color), ambient);
    if (!has_base) world->base[i] = i3_zero();
    world->diffuse[i] = i3_scale(i_from(m[CT_KD]), color);
  }
  for (size_t j = 0; j < v->n_lights; j++)
    world->light[j] = color3(v->lights + j * CT_LIGHT_COLUMNS);
  world->background = color3(v->background);
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
  world->base = malloc((v->n_objects + 1) * sizeof *world->base);
  world->diffuse = malloc((v->n_objects + 1) * sizeof *world->diffuse);
  world->light = malloc((v->n_lights + 1) * sizeof *world->light);
  world->is_twin = calloc(v->n_objects + 1, 1);
  if (!world->plane_normal || !world->base || !world->diffuse || !world->light ||
      !world->is_twin) {
    SET_FN(close)(world);
    return CT_ERR_MEMORY;
  }
  set_camera(world);
  set_materials(world);
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
