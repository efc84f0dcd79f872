/* The world of the certified streams: what is the same for every ray, beside that of the scalar
 * kernel (set_world.inc.h), and the streams themselves. */

typedef struct SET_FN(solid) {
  size_t object;
  int is_plane, is_eye_on;
  double g[CT_GEOMETRY_COLUMNS];
  double radius, inverse_radius, size; /* upper bounds of 1/r and |c|; |p| and |n| of a plane */
  double slant;
  IV square, inverse; /* r^2; 1/r or 1/|n| */
  IV mirror[3][3];    /* of a plane: I - 2 n n'/|n|^2 */
} SOLID;

/* With more solids than this, or more lights, none is passed over for where it is; with fewer,
 * asking costs more than it saves. */
enum { FEWEST_CULLED = 6, CULLED_SOLIDS = 64, CULLED_LIGHTS = 32 };

typedef struct SET_FN(stream_world) {
  WORLD *base;
  const ct_bvh *bvh; /* NULL: every solid is asked */
  /* Without those equal to an earlier one: it hides them. With a tree, those apart from it. */
  SOLID *solids;
  size_t n_solids;
  double *columns[5]; /* centre, r (infinite: a plane) and |c|; room for a vector beyond the last */
} SWORLD;

/* Where the widest vectors are read and written in one go. */
#define ALIGNED _Alignas(64)

/* Rays as arrays: (-lo, hi) of three components each. Room for a vector beyond the last. */
enum { ROOM = CT_SET_STREAM + N_LANES };
typedef struct SET_FN(stream) {
  ALIGNED double origin[6][ROOM];
  ALIGNED double direction[6][ROOM];
  double slot[ROOM];             /* which pixel of the batch */
  int n;
  const ct_medium *medium[ROOM]; /* but for nesting=relative */
} STREAM;

static inline void load_rays(const STREAM *rays, int at, VI o[3], VI d[3]) {
  for (int k = 0; k < 3; k++) {
    o[k] = vi(l_load(rays->origin[k] + at), l_load(rays->origin[3 + k] + at));
    d[k] = vi(l_load(rays->direction[k] + at), l_load(rays->direction[3 + k] + at));
  }
}

/* What all rays of a batch share. */
typedef struct SET_FN(batch) {
  const ct_set_limits *limits;
  unsigned char *open;
  int is_any_open;
  int counts; /* rays, as a pixel may send more than it is allowed */
  uint64_t n_rays[CT_SET_STREAM];
} BATCH;

static void leave_open(BATCH *batch, const STREAM *rays, int at, MASK lanes) {
  for (unsigned bits = m_bits(lanes); bits; bits &= bits - 1)
    batch->is_any_open = batch->open[(int)rays->slot[at + __builtin_ctz(bits)]] = 1;
}

static void set_mirror(const double *n, IV mirror[3][3]) {
  IV square = i3_square(i3_from(n));
  for (int k = 0; k < 3; k++)
    for (int j = 0; j < 3; j++) {
      IV part = i_over_positive(i_mul(i_from(2 * n[k]), i_from(n[j])), square);
      mirror[k][j] = i_sub(i_from(k == j), part);
    }
}

static SOLID solid_from(const WORLD *base, size_t i) {
  const ct_scene_view *v = base->view;
  const double *g = v->geometry + i * CT_GEOMETRY_COLUMNS;
  SOLID s = {.object = i, .is_plane = v->kind[i] == CT_PLANE, .is_eye_on = base->frame->eye_on[i]};
  memcpy(s.g, g, sizeof s.g);
  s.size = fabs(g[0]) + fabs(g[1]) + fabs(g[2]); /* rounded upward, as all here */
  if (s.is_plane) {
    s.slant = fabs(g[3]) + fabs(g[4]) + fabs(g[5]);
    s.inverse = i_over_positive(i_from(1), i3_length(i3_from(g + 3)));
    set_mirror(g + 3, s.mirror);
  } else {
    s.radius = g[3];
    s.square = i_square(i_from(g[3]));
    s.inverse = i_over_positive(i_from(1), i_from(g[3]));
    s.inverse_radius = s.inverse.hi;
  }
  return s;
}

static void SET_FN(close_stream)(void *opaque) {
  SWORLD *world = opaque;
  if (world->base) SET_FN(close)(world->base);
  free(world->solids);
  free(world->columns[0]);
  free(world);
}

/* The numbers of solids by column, to be compared side by side. */
static int lay_out(SWORLD *world) {
  size_t room = world->n_solids + N_LANES;
  double *columns = calloc(5 * room, sizeof *columns);
  if (!columns) return 0;
  for (size_t c = 0; c < 5; c++) world->columns[c] = columns + c * room;
  for (size_t i = 0; i < world->n_solids; i++) {
    const SOLID *s = &world->solids[i];
    for (int c = 0; c < 3; c++) world->columns[c][i] = s->g[c];
    world->columns[3][i] = s->is_plane ? (double)INFINITY : s->g[3];
    world->columns[4][i] = s->size;
  }
  return 1;
}

static ct_status SET_FN(open_stream)(const ct_frame *frame, void **out) {
  SWORLD *world = calloc(1, sizeof *world);
  void *base = NULL;
  if (!world) return CT_ERR_MEMORY;
  ct_status status = SET_FN(open)(frame, 0, &base);
  if (status) {
    free(world);
    return status;
  }
  world->base = base;
  const ct_bvh *bvh = world->bvh = frame->bvh;
  size_t n = bvh ? bvh->n_apart : frame->view.n_objects;
  world->solids = malloc((n + 1) * sizeof *world->solids);
  if (!world->solids) {
    SET_FN(close_stream)(world);
    return CT_ERR_MEMORY;
  }
  for (size_t k = 0; k < n; k++) {
    size_t i = bvh ? bvh->apart[k] : k;
    if (!world->base->is_twin[i]) world->solids[world->n_solids++] = solid_from(world->base, i);
  }
  if (!lay_out(world)) {
    SET_FN(close_stream)(world);
    return CT_ERR_MEMORY;
  }
  *out = world;
  return CT_OK;
}
