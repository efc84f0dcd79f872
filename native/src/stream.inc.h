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

#include CT_LANES
#include "lanes_vector.inc.h"
#include "stream_world.inc.h"
#include "stream_store.inc.h"
#include "stream_hit.inc.h"
#include "stream_cull.inc.h"
#include "stream_trace.inc.h"

/* The way of the ray through the centre of each pixel (specification 2.3), not of length 1. */
static void aim(const WORLD *world, const ct_tile *tile, int64_t top, int64_t bottom,
                BUNDLE *bundle) {
  const ct_scene_view *v = world->view;
  size_t n = 0;
  for (int64_t row = top; row < bottom; row++)
    for (int64_t column = tile->left; column < tile->right; column++, n++) {
      /* Halves of integers: exact in every type. */
      bundle->direction.x[n] = from_double((double)column - (double)v->h_res / 2 + 0.5);
      bundle->direction.y[n] = from_double((double)row - (double)v->v_res / 2 + 0.5);
    }
  bundle->n = n;
  LANES s = l_all(from_double(v->pixel_size));
  VECS eye = vs_all(world->eye);
  VECS forward = vs_all(v_scale(from_double(v->screen_distance), world->w));
  for (size_t at = 0; at < n; at += N_LANES) {
    LANES x = s * l_load(bundle->direction.x + at), y = -(s * l_load(bundle->direction.y + at));
    VECS across = vs_add(vs_scale(x, vs_all(world->u)), vs_scale(y, vs_all(world->v)));
    vs_store(&bundle->direction, at, vs_sub(across, forward));
    vs_store(&bundle->origin, at, eye);
  }
}

static void put(const COLUMNS *c, size_t k, double *out) {
  out[0] = to_double(c->x[k]);
  out[1] = to_double(c->y[k]);
  out[2] = to_double(c->z[k]);
}

/* Writes pixel k of a bundle. */
static void deliver(const STORE *store, const BUNDLE *bundle, size_t k, const ct_outputs *out,
                    size_t pixel) {
  const FIRST *first = &store->first;
  if (out->image) put(&bundle->color, k, out->image + 3 * pixel);
  if (out->image_low) memset(out->image_low + 3 * pixel, 0, 3 * sizeof *out->image_low);
  if (out->tree) out->tree[pixel] = bundle->tree[k];
  if (out->rays) out->rays[pixel] = bundle->rays[k];
  if (store->wants_hit) {
    int is_hit = first->object[k] >= 0;
    if (out->object) out->object[pixel] = (int32_t)first->object[k];
    if (out->t_world) out->t_world[pixel] = is_hit ? to_double(first->t[k]) : (double)INFINITY;
    if (out->normal) put(&first->normal, k, out->normal + 3 * pixel);
  }
  for (size_t term = 0; out->contributions && term < CT_CONTRIBUTIONS; term++)
    put(&first->split[term], k, out->contributions + 3 * (pixel * CT_CONTRIBUTIONS + term));
}

static void FN(tile)(const void *opaque, void *opaque_store, const ct_tile *tile,
                     ct_pixel *pixel) {
  const STAGE *stage = opaque;
  STORE *store = opaque_store;
  int64_t across = tile->right - tile->left, rows = BUNDLE_RAYS / across;
  store->pixel = pixel;
  for (int64_t top = tile->top; top < tile->bottom; top += rows) {
    int64_t bottom = top + rows < tile->bottom ? top + rows : tile->bottom;
    store->used = 0;
    BUNDLE bundle = take_bundle(store, BUNDLE_RAYS);
    if (store->wants_hit) {
      store->first.object = take(store, rounded_up(BUNDLE_RAYS), sizeof *store->first.object);
      store->first.t = take(store, rounded_up(BUNDLE_RAYS), sizeof *store->first.t);
      store->first.normal = take_columns(store, rounded_up(BUNDLE_RAYS));
    }
    if (store->wants_split) {
      store->first.total = take(store, rounded_up(BUNDLE_RAYS), sizeof *store->first.total);
      for (int k = 0; k < CT_CONTRIBUTIONS; k++)
        store->first.split[k] = take_columns(store, rounded_up(BUNDLE_RAYS));
    }
    aim(stage->world, tile, top, bottom, &bundle);
    trace_first(store, &bundle);
    if (is_stopped(store)) return;
    size_t k = 0;
    for (int64_t row = top; row < bottom; row++)
      for (int64_t column = tile->left; column < tile->right; column++, k++) {
        size_t line = (size_t)(row - tile->row_begin) * (size_t)stage->world->view->h_res;
        deliver(store, &bundle, k, tile->out, line + (size_t)column);
      }
  }
}

const ct_stream FN(ct_stream) = {FN(open_stage), FN(close_stage), FN(enter), FN(leave),
                                 FN(tile)};
