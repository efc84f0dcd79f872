/* The certified streams for one instruction set (set_lanes_*.h).
 *
 * A stream of rays is met with all solids vector by vector; each vector is shaded once for every
 * solid that it meets; secondary rays are packed into two child streams, so that lanes stay full at
 * any depth, and what these return is added where they came from. A decision that is not certain
 * leaves its pixel open, and the pixel's other rays are dropped as they come up.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define INLINE static inline __attribute__((always_inline))
#define APART static __attribute__((noinline))

#include "bvh_walk.h"
#include "kernel.h"
#include "set_stream.h"
#include "interval.inc.h"
#include "set_world.inc.h"
#include "set_stream_interval.inc.h"
#include "set_stream_world.inc.h"
#include "set_stream_hit.inc.h"
#include "set_stream_cull.inc.h"
#include "set_stream_shadow.inc.h"
#include "set_stream_point.inc.h"
#include "set_stream_scatter.inc.h"
#include "set_stream_primary.inc.h"

/* Deeper rays are left to the scalar kernel: a level of the recursion takes much stack. */
enum { DEEPEST = 1000 };

typedef struct SET_FN(colors) {
  ALIGNED double channel[6][ROOM]; /* (-lo, hi) of three channels */
} COLORS;

/* The lanes of a vector whose pixels are still worth tracing; counts their rays. */
static MASK living_lanes(BATCH *batch, const STREAM *rays, int at) {
  unsigned bits = 0;
  int n = rays->n - at < N_LANES ? rays->n - at : N_LANES;
  if (!batch->is_any_open && !batch->counts) return m_from_bits((1u << n) - 1);
  for (int k = 0; k < n; k++) {
    int slot = (int)rays->slot[at + k];
    if (batch->counts && ++batch->n_rays[slot] > batch->limits->n_rays)
      batch->is_any_open = batch->open[slot] = 1;
    if (!batch->open[slot]) bits |= 1u << k;
  }
  return m_from_bits(bits);
}

/* The solid of that index (NEAREST). */
static const SOLID *solid_at(const SWORLD *world, size_t index, SOLID *room) {
  if (!world->bvh) return &world->solids[index];
  *room = solid_from(world->base, index);
  return room;
}

/* The light of the hits of one solid, and their secondary rays. */
INLINE void shade(const SWORLD *world, SIGHT *sight, const STREAM *rays, int at, int is_last,
                  const VI o[3], const VI d[3], const VS3 *d_signed, const NEAREST *nearest,
                  const SOLID *solid, MASK lanes, VI color[3], CHILD *mirrored, CHILD *refracted,
                  MASK *bad) {
  const WORLD *base = world->base;
  IV3 flat = base_of(base, solid->object);
  VI sum[3] = {vi_from(flat.x), vi_from(flat.y), vi_from(flat.z)};
  if (base->view->delivery > 1) {
    HITS hit;
    enclose_hits(o, d, d_signed, solid, nearest, &hit);
    const double *m = base->view->material + solid->object * CT_MATERIAL_COLUMNS;
    int has_light = ((base->effects & CT_DIFFUSE) && m[CT_KD] > 0) ||
                    ((base->effects & CT_SPECULAR) && m[CT_KS] > 0);
    for (size_t j = 0; has_light && j < base->view->n_lights; j++)
      add_light(world, sight, &hit, j, lanes, sum, bad);
    if (base->view->delivery == 3 && !is_last)
      scatter(world, &hit, d, rays, at, m_but(lanes, *bad), mirrored, refracted, bad);
  }
  for (int k = 0; k < 3; k++) color[k] = vi_select(lanes, sum[k], color[k]);
}

/* What rays hit. Leaves in `lanes` those in which that is certain, and adds the others to `bad`. */
INLINE NEAREST find_hits(const SWORLD *world, SIGHT *sight, const VI o[3], const VI d[3],
                         int64_t depth, MASK *lanes, MASK *bad) {
  MIDDLE q;
  MASK doubt;
  *bad = m_or(*bad, m_but(*lanes, middle_of(o, d, &q)));
  *lanes = m_but(*lanes, *bad);
  NEAREST nearest = nearest_of(world, sight->targets, o, d, &q, depth == 0, *lanes, &doubt);
  *bad = m_or(*bad, doubt);
  *lanes = m_but(*lanes, doubt);
  if (sight->culls)
    note_hits(sight, &q, &nearest, m_but(*lanes, i_equal(nearest.object, i_all(-1))));
  return nearest;
}

/* The light of all hits of a vector, solid by solid. */
INLINE void shade_hits(const SWORLD *world, SIGHT *sight, const STREAM *rays, int at, int is_last,
                       const VI o[3], const VI d[3], const NEAREST *nearest, MASK lanes,
                       COLORS *out, CHILD *mirrored, CHILD *refracted, MASK *bad) {
  const IV3 *back = &world->base->background;
  VI color[3] = {vi_from(back->x), vi_from(back->y), vi_from(back->z)};
  VS3 d_signed = vs3_of(d);
  LANE_ID objects[N_LANES];
  i_store(objects, nearest->object);
  unsigned left = m_bits(m_but(lanes, i_equal(nearest->object, i_all(-1))));
  while (left) {
    LANE_ID index = objects[__builtin_ctz(left)];
    MASK group = m_and(m_from_bits(left), i_equal(nearest->object, i_all(index)));
    SOLID own;
    shade(world, sight, rays, at, is_last, o, d, &d_signed, nearest,
          solid_at(world, (size_t)index, &own), group, color, mirrored, refracted, bad);
    left &= ~m_bits(group);
  }
  for (int k = 0; k < 3; k++) {
    l_store(out->channel[k] + at, color[k].n);
    l_store(out->channel[3 + k] + at, color[k].h);
  }
}

static void clear_colors(COLORS *out, int at) {
  for (int k = 0; k < 6; k++) l_store(out->channel[k] + at, l_all(0));
}

/* The next two are not inlined, so that a level of the recursion does not hold what they need. */
APART void trace_vector(const SWORLD *world, BATCH *batch, const STREAM *rays, int at,
                        int64_t depth, COLORS *out, CHILD *mirrored, CHILD *refracted) {
  SIGHT everything;
  everything.culls = 0;
  everything.targets = ~UINT64_C(0);
  MASK lanes = living_lanes(batch, rays, at), bad = m_none();
  if (!m_any(lanes)) {
    clear_colors(out, at);
    return;
  }
  VI o[3], d[3];
  load_rays(rays, at, o, d);
  NEAREST nearest = find_hits(world, &everything, o, d, depth, &lanes, &bad);
  shade_hits(world, &everything, rays, at, depth >= world->base->frame->max_depth, o, d, &nearest,
             lanes, out, mirrored, refracted, &bad);
  leave_open(batch, rays, at, bad);
}

/* First what all of the rays hit: then what cannot stand before a light is known for all. */
APART void trace_in_sight(const SWORLD *world, BATCH *batch, const STREAM *rays, int64_t depth,
                          COLORS *out, CHILD *mirrored, CHILD *refracted) {
  enum { N_VECTORS = ROOM / N_LANES };
  SIGHT sight;
  NEAREST nearest[N_VECTORS];
  MASK lanes[N_VECTORS];
  VI o[3], d[3];
  look(world, rays, &sight);
  for (int at = 0; at < rays->n; at += N_LANES) {
    int v = at / N_LANES;
    MASK bad = m_none();
    lanes[v] = living_lanes(batch, rays, at);
    if (!m_any(lanes[v])) continue;
    load_rays(rays, at, o, d);
    nearest[v] = find_hits(world, &sight, o, d, depth, &lanes[v], &bad);
    leave_open(batch, rays, at, bad);
  }
  for (int at = 0; at < rays->n; at += N_LANES) {
    int v = at / N_LANES;
    MASK bad = m_none();
    if (!m_any(lanes[v])) {
      clear_colors(out, at);
      continue;
    }
    load_rays(rays, at, o, d);
    shade_hits(world, &sight, rays, at, depth >= world->base->frame->max_depth, o, d, nearest + v,
               lanes[v], out, mirrored, refracted, &bad);
    leave_open(batch, rays, at, bad);
  }
}

/* Adds what the rays of a child stream returned to the rays that they came from. */
static void add_child(const CHILD *child, const COLORS *colors, COLORS *out) {
  for (int i = 0; i < child->n_records; i++) {
    const RECORD *r = &child->records[i];
    MASK lanes = m_from_bits(r->bits);
    int to = r->vector * N_LANES;
    for (int k = 0; k < 6; k++) {
      LANES more = l_unpack(lanes, l_load(colors->channel[k] + r->at)) * r->weight;
      LANES own = l_load(out->channel[k] + to);
      l_store(out->channel[k] + to, l_blend(lanes, own + more, own));
    }
  }
}

static void trace_stream(const SWORLD *world, BATCH *batch, const STREAM *rays, int64_t depth,
                         COLORS *out) {
  CHILD mirrored, refracted;
  COLORS colors;
  int culls = world->n_solids >= FEWEST_CULLED && world->n_solids <= CULLED_SOLIDS;
  mirrored.rays.n = mirrored.n_records = refracted.rays.n = refracted.n_records = 0;
  if (depth > DEEPEST || atomic_load_explicit(batch->limits->stop, memory_order_relaxed)) {
    memset(out, 0, sizeof *out);
    for (int i = 0; i < rays->n; i++) batch->open[(int)rays->slot[i]] = 1;
    batch->is_any_open = 1;
    return;
  }
  if (culls)
    trace_in_sight(world, batch, rays, depth, out, &mirrored, &refracted);
  else
    for (int at = 0; at < rays->n; at += N_LANES)
      trace_vector(world, batch, rays, at, depth, out, &mirrored, &refracted);
  if (mirrored.rays.n > 0) {
    trace_stream(world, batch, &mirrored.rays, depth + 1, &colors);
    add_child(&mirrored, &colors, out);
  }
  if (refracted.rays.n > 0) {
    trace_stream(world, batch, &refracted.rays, depth + 1, &colors);
    add_child(&refracted, &colors, out);
  }
}

static void SET_FN(batch)(const void *opaque, const int64_t *pixels, int n,
                          const ct_set_limits *limits, ct_set_batch *out) {
  const SWORLD *world = opaque;
  STREAM rays;
  COLORS colors;
  int64_t depth = world->base->frame->max_depth;
  BATCH batch; /* its counts are of use where a pixel may send more rays than it is allowed */
  batch.limits = limits;
  batch.open = out->open;
  batch.is_any_open = 0;
  batch.counts = depth > 60 || limits->n_rays < UINT64_C(2) << depth;
  if (batch.counts) memset(batch.n_rays, 0, sizeof batch.n_rays);
  memset(out->open, 0, sizeof out->open);
  aim(world, pixels, n, &rays);
  trace_stream(world, &batch, &rays, 0, &colors);
  for (int k = 0; k < 3; k++)
    for (int i = 0; i < n; i++) {
      /* No zero with a sign, which is the one thing that instruction sets do not agree on. */
      out->lo[k][i] = 0.0 - colors.channel[k][i];
      out->hi[k][i] = 0.0 + colors.channel[3 + k][i];
    }
}

const ct_set_stream SET_FN(ct_set_stream) = {SET_FN(open_stream), SET_FN(close_stream),
                                             SET_FN(batch)};
