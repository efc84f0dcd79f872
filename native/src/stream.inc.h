/* The stream of one precision and one instruction set. The includer defines the scalar type
 * (real_*.h) and its suffix, names the kernel (CT_RUNG) and the lanes (CT_LANES); this text defines
 * FN(ct_stream), with the scalar kernel beside it for rays too deep for a stream.
 */
#define CT_PRIMITIVES "prim_plain.inc.h"
#define CT_STACK_PER_LEVEL 4096
#define CT_TAKES_ROUNDING 0
#include "kernel.inc.h"

#include <string.h>

#include "stream.h"

#define INLINE static inline __attribute__((always_inline))
#define APART static __attribute__((noinline))

#include CT_LANES
#include "lanes_vector.inc.h"
#include "stream_world.inc.h"
#include "stream_hit.inc.h"
#include "stream_cull.inc.h"
#include "stream_tree.inc.h"
#include "stream_store.inc.h"
#include "stream_prune.inc.h"
#include "stream_sight.inc.h"
#include "stream_light.inc.h"
#include "stream_shade.inc.h"
#include "stream_trace.inc.h"

/* The ways of the rays through the centres of a rectangle of pixels (specification 2.3), or points
 * near them, not of length 1. */
static void aim(const WORLD *world, const ct_tile *pixels, BUNDLE *bundle) {
  const ct_scene_view *v = world->view;
  REAL *across = bundle->direction.x, *down = bundle->direction.y;
  size_t n = 0, n_across = (size_t)(pixels->right - pixels->left);
  for (int64_t row = pixels->top; row < pixels->bottom; row++, n += n_across)
    for (size_t k = 0; k < n_across; k++) {
      double right, below;
      ct_sample_point(world->frame, row, pixels->left + (int64_t)k, &right, &below);
      across[n + k] = from_double(right);
      down[n + k] = from_double(below);
    }
  bundle->n = n;
  LANES s = l_all(from_double(v->pixel_size));
  VECS eye = vs_all(world->eye);
  VECS forward = vs_all(v_scale(from_double(v->screen_distance), world->w));
  for (size_t at = 0; at < n; at += N_LANES) {
    LANES x = s * l_load(across + at), y = -(s * l_load(down + at));
    VECS way = vs_add(vs_scale(x, vs_all(world->u)), vs_scale(y, vs_all(world->v)));
    vs_store(&bundle->direction, at, vs_sub(way, forward));
    vs_store(&bundle->origin, at, eye);
    if (bundle->slack) l_store(bundle->slack + at, l_all(from_double(world->reach.slack)));
  }
}

/* Writes n vectors from number k on, `stride` doubles apart. */
static inline void put(const COLUMNS *c, size_t k, size_t n, double *out, size_t stride) {
  const REAL *x = c->x + k, *y = c->y + k, *z = c->z + k;
  /* Known when compiled, so that the compiler can interleave whole vectors. */
  for (size_t i = 0; stride == 3 && i < n; i++) {
    out[i * 3] = to_double(x[i]);
    out[i * 3 + 1] = to_double(y[i]);
    out[i * 3 + 2] = to_double(z[i]);
  }
  for (size_t i = 0; stride != 3 && i < n; i++) {
    out[i * stride] = to_double(x[i]);
    out[i * stride + 1] = to_double(y[i]);
    out[i * stride + 2] = to_double(z[i]);
  }
}

/* Writes n pixels of a row, which are numbers k and on of the bundle. */
static void deliver(const STORE *store, const BUNDLE *bundle, size_t k, size_t n,
                    const ct_outputs *out, size_t pixel) {
  const FIRST *first = &store->first;
  if (out->image) put(&bundle->color, k, n, out->image + 3 * pixel, 3);
  if (out->image_low) memset(out->image_low + 3 * pixel, 0, 3 * n * sizeof *out->image_low);
  if (out->tree) memcpy(out->tree + pixel, bundle->tree + k, n * sizeof *out->tree);
  if (out->rays) memcpy(out->rays + pixel, bundle->rays + k, n * sizeof *out->rays);
  for (size_t i = 0; out->object && i < n; i++)
    out->object[pixel + i] = (int32_t)first->object[k + i];
  for (size_t i = 0; out->t_world && i < n; i++) {
    int is_hit = first->object[k + i] >= 0;
    out->t_world[pixel + i] = is_hit ? to_double(first->t[k + i]) : (double)INFINITY;
  }
  if (out->normal) put(&first->normal, k, n, out->normal + 3 * pixel, 3);
  for (size_t term = 0; out->contributions && term < CT_CONTRIBUTIONS; term++)
    put(&first->split[term], k, n, out->contributions + 3 * (pixel * CT_CONTRIBUTIONS + term),
        3 * CT_CONTRIBUTIONS);
}

static void FN(tile)(const void *opaque, void *opaque_store, const ct_tile *tile,
                     ct_pixel *pixel) {
  const STAGE *stage = opaque;
  STORE *store = opaque_store;
  int64_t across = tile->right - tile->left, rows = BUNDLE_RAYS / across;
  store->pixel = pixel;
  for (int64_t top = tile->top; top < tile->bottom; top += rows) {
    ct_tile part = *tile;
    part.top = top;
    if (top + rows < tile->bottom) part.bottom = top + rows;
    store->used = 0;
    BUNDLE bundle = take_bundle(store, BUNDLE_RAYS);
    take_first(store);
    aim(stage->world, &part, &bundle);
    trace_first(store, &bundle);
    if (is_stopped(store)) return;
    size_t k = 0;
    for (int64_t row = top; row < part.bottom; row++, k += (size_t)across)
      deliver(store, &bundle, k, (size_t)across, tile->out,
              tile->at + (size_t)(row - tile->top) * tile->stride);
  }
}

#if REAL_DIGITS == 53
#include "stream_intersect.inc.h"
#define OF_DOUBLE(function) FN(function)
#else
#define OF_DOUBLE(function) NULL
#endif

const ct_stream FN(ct_stream) = {FN(open_stage), FN(close_stage),      FN(enter),
                                 FN(leave),      FN(tile),             OF_DOUBLE(intersect),
                                 OF_DOUBLE(multiply_and_add)};
