/* What one thread holds of rays on their way: bundles of one depth, in columns, one below another
 * in a store that is as deep as the stream recurses. */

/* Rays in a bundle: enough for full lanes at depth, few enough for the processor's caches. */
enum { BUNDLE_RAYS = 256 };

/* Rays deeper than this go on one by one in the scalar kernel. */
enum { STREAM_LEVELS = 64 };

/* With more lamps than this, no object is left out on the way to any. */
enum { CULLED_LAMPS = 32 };

/* With a tree, as many lists as there are lamps that objects are left out for. */
static size_t n_culled_lamps(const STAGE *stage) {
  return stage->n_lamps > 0 && stage->n_lamps <= CULLED_LAMPS ? stage->n_lamps : 1;
}

typedef struct FN(bundle) {
  size_t n;
  /* Directions of any length; origins at the hit that the rays leave. */
  COLUMNS origin, direction, color;
  uint64_t *tree; /* NULL: nobody asks */
  uint32_t *rays; /* NULL: nobody asks */
  REAL *slack;    /* NULL: nothing is pruned */
} FN(bundle);
#define BUNDLE FN(bundle)

/* Rays sent on together: the vector of the bundle that they come from, and the lanes in it. */
typedef struct FN(parcel) {
  uint16_t at, lanes;
} FN(parcel);
#define PARCEL FN(parcel)

/* Rays that a bundle sends on, packed, parcel by parcel. */
typedef struct FN(branch) {
  BUNDLE rays;
  REAL *weight; /* of every ray in the sum that it goes back to */
  PARCEL *parcel;
  size_t n_parcels;
} FN(branch);
#define BRANCH FN(branch)

/* What is asked of the first hits. */
typedef struct FN(first) {
  LANE_ID *object;
  REAL *t;
  COLUMNS normal, split[CT_CONTRIBUTIONS];
  uint16_t *total; /* for every vector, the lanes of total reflection */
} FN(first);
#define FIRST FN(first)

typedef struct FN(store) {
  const STAGE *stage;
  ct_pixel *pixel;
  int wants_tree, wants_rays, wants_hit, wants_split;
  FIRST first;
  size_t used, size;
  void *block; /* as allocated */
  unsigned char *memory;
} FN(store);
#define STORE FN(store)

enum { STORE_LINE = 64 };

static void *take(STORE *store, size_t n, size_t size) {
  void *taken = store->memory + store->used;
  store->used += (n * size + STORE_LINE - 1) / STORE_LINE * STORE_LINE;
  return taken;
}

static COLUMNS take_columns(STORE *store, size_t n) {
  COLUMNS c;
  c.x = take(store, n, sizeof *c.x);
  c.y = take(store, n, sizeof *c.y);
  c.z = take(store, n, sizeof *c.z);
  return c;
}

/* Rays for whole vectors, and one more for what packing leaves behind them. */
static size_t rounded_up(size_t n) { return (n + 2 * N_LANES - 1) / N_LANES * N_LANES; }

static BUNDLE take_bundle(STORE *store, size_t n) {
  size_t room = rounded_up(n);
  BUNDLE b = {.n = 0};
  b.origin = take_columns(store, room);
  b.direction = take_columns(store, room);
  b.color = take_columns(store, room);
  if (store->wants_tree) b.tree = take(store, room, sizeof *b.tree);
  if (store->wants_rays) b.rays = take(store, room, sizeof *b.rays);
  if (store->stage->world->reach.slack > 0) b.slack = take(store, room, sizeof *b.slack);
  return b;
}

static BRANCH take_branch(STORE *store, size_t n) {
  BRANCH b;
  b.rays = take_bundle(store, n);
  b.weight = take(store, rounded_up(n), sizeof *b.weight);
  b.parcel = take(store, n, sizeof *b.parcel);
  b.n_parcels = 0;
  return b;
}

static void take_first(STORE *store) {
  FIRST *first = &store->first;
  size_t room = rounded_up(BUNDLE_RAYS);
  if (store->wants_hit) {
    first->object = take(store, room, sizeof *first->object);
    first->t = take(store, room, sizeof *first->t);
    first->normal = take_columns(store, room);
  }
  if (!store->wants_split) return;
  first->total = take(store, room / N_LANES, sizeof *first->total);
  for (int k = 0; k < CT_CONTRIBUTIONS; k++) first->split[k] = take_columns(store, room);
}

/* For what may be hit, and for what may stand before each lamp. */
static LIST *take_lists(STORE *store) {
  size_t n = 1 + n_culled_lamps(store->stage);
  LIST *lists = take(store, n, sizeof *lists);
  for (size_t k = 0; k < n; k++) {
    lists[k].shape = take(store, LISTED, sizeof *lists[k].shape);
    lists[k].object = take(store, LISTED, sizeof *lists[k].object);
    lists[k].from = take(store, LISTED, sizeof *lists[k].from);
  }
  return lists;
}

static void FN(leave)(void *opaque) {
  STORE *store = opaque;
  if (!store) return;
  free(store->block);
  free(store);
}

static void *FN(enter)(const void *opaque, const ct_outputs *out) {
  const STAGE *stage = opaque;
  STORE *store = calloc(1, sizeof *store);
  if (!store) return NULL;
  store->stage = stage;
  store->wants_tree = out->tree != NULL;
  store->wants_rays = out->rays != NULL;
  store->wants_hit = out->object || out->t_world || out->normal;
  store->wants_split = out->contributions != NULL;
  int64_t depth = stage->world->frame->max_depth;
  size_t n_levels = 1 + (size_t)(depth < STREAM_LEVELS ? depth : STREAM_LEVELS);
  /* At most, with a line for every array: two branches a level, the first bundle, the first hits. */
  size_t columns = 9 + 1 + 1 + 1, room = rounded_up(BUNDLE_RAYS);
  size_t branch = (columns + 2) * (room * sizeof(uint64_t) + STORE_LINE);
  size_t first = (CT_CONTRIBUTIONS * 3 + 6) * (room * sizeof(uint64_t) + STORE_LINE);
  size_t sight = (1 + CULLED_LAMPS) * stage->n_words * sizeof(uint64_t) + STORE_LINE;
  size_t list = sizeof(LIST) + LISTED * (sizeof(SHAPE) + sizeof(uint32_t) + sizeof(REAL)) + 4 * STORE_LINE;
  if (stage->bvh) sight += (1 + n_culled_lamps(stage)) * list;
  store->size = (2 * n_levels + 1) * branch + (n_levels + 1) * sight + first + STORE_LINE;
  store->block = malloc(store->size);
  if (!store->block) {
    free(store);
    return NULL;
  }
  uintptr_t start = (uintptr_t)store->block;
  store->memory = (unsigned char *)store->block + (STORE_LINE - start % STORE_LINE) % STORE_LINE;
  return store;
}
