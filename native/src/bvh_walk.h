/* A walk along a ray, or along all rays of a beam, through the boxes of a tree: leaf by leaf, nearer
 * ones first. Internal.
 *
 * A box is bounded by six planes, and each says from which t on, or up to which, the ray is on its
 * inner side: (plane - o) / d. A beam is every ray whose origin and direction lie in two boxes; for a
 * plane the corner counts that gets inside of it the soonest, and stays for the longest.
 *
 * No leaf is passed over that holds a sphere which a kernel says is hit no farther than `before`. A
 * kernel's rounded roots are those of nearly the same sphere: for either of them, o + t*d lies within
 * K u (|o - c| + r) of the sphere, where u is its type's unit, K below 64, and | |d|^2 - 1 | of d below
 * a few u or counted besides. The boxes are moved outward by `slack`, which is more than that and
 * the walk's own errors together: of float, 2^-24 each of o, d, a difference, a quotient and a
 * product, and twice as much where the processor rounds upward, so less than 2^-20 of |o| + the tree's
 * reach in each coordinate.
 */
#ifndef CT_BVH_WALK_H
#define CT_BVH_WALK_H

#include <float.h>
#include <math.h>

#include "bvh.h"

#if defined(__AVX__)
#include <immintrin.h>
#elif defined(__SSE2__)
#include <emmintrin.h>
#endif

#define CT_WALK_SLACK 0x1p-19
/* Divisors nearer to 0 are this: over the distances in a tree it makes no difference. */
#define CT_WALK_LEAST 1e-18f

enum { CT_WALK_ROOM = (CT_BVH_WIDTH - 1) * CT_BVH_DEPTH + CT_BVH_WIDTH };

/* Planes of a box that are one side's limit: their rows in a node, what to take off, a factor. */
typedef struct ct_walk_limit {
  int row;
  float from, by;
} ct_walk_limit;

typedef struct ct_walk {
  const ct_bvh *bvh;
  int n_lower, n_upper, n_open; /* n_open: entries of the stack */
  ct_walk_limit lower[6], upper[6];
  uint32_t open[CT_WALK_ROOM];
  float at[CT_WALK_ROOM];
} ct_walk;

static inline void ct_walk_limit_add(ct_walk *w, int row, double from, double direction) {
  float d = (float)direction;
  if (!(fabsf(d) > CT_WALK_LEAST)) d = d < 0 ? -CT_WALK_LEAST : CT_WALK_LEAST;
  /* A high plane (rows 3 to 5) is left by a ray that rises, entered by one that falls. */
  int is_upper = (row >= 3) == (d > 0);
  ct_walk_limit *l = is_upper ? &w->upper[w->n_upper++] : &w->lower[w->n_lower++];
  *l = (ct_walk_limit){row, (float)from, 1.0f / d};
}

/* Starts a walk along the rays with origins in [o_low, o_high] and directions in [d_low, d_high];
 * `slack` is relative, of the kernel's test. */
static inline void ct_walk_start(ct_walk *w, const ct_bvh *bvh, const double o_low[3],
                                 const double o_high[3], const double d_low[3],
                                 const double d_high[3], double slack) {
  double from = 0, middle[2][3];
  for (int k = 0; k < 3; k++) {
    middle[0][k] = o_low[k] - bvh->middle[k];
    middle[1][k] = o_high[k] - bvh->middle[k];
    double most = fmax(fabs(middle[0][k]), fabs(middle[1][k]));
    from = from > most ? from : most;
  }
  double move = (slack + CT_WALK_SLACK) * (from + bvh->reach) +
                (0x1p-48 + 0x1p-4 * slack) * (from + bvh->extent);
  w->bvh = bvh;
  w->n_lower = w->n_upper = 0;
  w->open[0] = 0;
  w->at[0] = 0;
  w->n_open = 1;
  if (!(move < 1e17)) { /* also where something is no number */
    w->lower[w->n_lower++] = (ct_walk_limit){0, 0, 1e-30f}; /* 0 for every box that is not empty */
    return;
  }
  for (int k = 0; k < 3; k++) {
    ct_walk_limit_add(w, k, middle[1][k] + move, d_high[k]);
    ct_walk_limit_add(w, 3 + k, middle[0][k] - move, d_low[k]);
  }
}

/* The limit of eight boxes: (plane - from) * by. Bits of the children that the walk is to enter, and
 * in near[] from where on. */
static inline unsigned ct_walk_enter(const ct_walk *w, const ct_bvh_node *node, int n_lower,
                                     int n_upper, float before, float near[CT_BVH_WIDTH]) {
#if defined(__AVX__)
  __m256 low = _mm256_setzero_ps(), high = _mm256_set1_ps(before);
  for (int k = 0; k < n_lower; k++) {
    const ct_walk_limit *l = w->lower + k;
    __m256 t = _mm256_mul_ps(_mm256_sub_ps(_mm256_loadu_ps(node->bound[l->row]),
                                           _mm256_broadcast_ss(&l->from)),
                             _mm256_broadcast_ss(&l->by));
    low = _mm256_max_ps(t, low);
  }
  for (int k = 0; k < n_upper; k++) {
    const ct_walk_limit *l = w->upper + k;
    __m256 t = _mm256_mul_ps(_mm256_sub_ps(_mm256_loadu_ps(node->bound[l->row]),
                                           _mm256_broadcast_ss(&l->from)),
                             _mm256_broadcast_ss(&l->by));
    high = _mm256_min_ps(t, high);
  }
  _mm256_storeu_ps(near, low);
  return (unsigned)_mm256_movemask_ps(_mm256_cmp_ps(low, high, _CMP_LE_OQ));
#elif defined(__SSE2__)
  unsigned bits = 0;
  for (int half = 0; half < CT_BVH_WIDTH; half += 4) {
    __m128 low = _mm_setzero_ps(), high = _mm_set1_ps(before);
    for (int k = 0; k < n_lower; k++) {
      const ct_walk_limit *l = w->lower + k;
      low = _mm_max_ps(_mm_mul_ps(_mm_sub_ps(_mm_loadu_ps(node->bound[l->row] + half),
                                             _mm_set1_ps(l->from)),
                                  _mm_set1_ps(l->by)), low);
    }
    for (int k = 0; k < n_upper; k++) {
      const ct_walk_limit *l = w->upper + k;
      high = _mm_min_ps(_mm_mul_ps(_mm_sub_ps(_mm_loadu_ps(node->bound[l->row] + half),
                                              _mm_set1_ps(l->from)),
                                   _mm_set1_ps(l->by)), high);
    }
    _mm_storeu_ps(near + half, low);
    bits |= (unsigned)_mm_movemask_ps(_mm_cmple_ps(low, high)) << half;
  }
  return bits;
#else
  unsigned bits = 0;
  for (int j = 0; j < CT_BVH_WIDTH; j++) {
    float low = 0, high = before;
    for (int k = 0; k < n_lower; k++) {
      float t = (node->bound[w->lower[k].row][j] - w->lower[k].from) * w->lower[k].by;
      low = t > low ? t : low;
    }
    for (int k = 0; k < n_upper; k++) {
      float t = (node->bound[w->upper[k].row][j] - w->upper[k].from) * w->upper[k].by;
      high = t < high ? t : high;
    }
    near[j] = low;
    bits |= (unsigned)(low <= high) << j;
  }
  return bits;
#endif
}

/* A limit for ct_walk_next that is not below t, and finite: empty boxes lie at infinity. */
static inline float ct_walk_before(double t) {
  return t < 1e38 ? (float)(t + fabs(t) * 0x1p-22) : FLT_MAX;
}

/* What a reference to a leaf says. */
static inline void ct_walk_leaf(uint32_t leaf, size_t *first, unsigned *n) {
  *first = leaf & (CT_BVH_MOST_OBJECTS - 1);
  *n = (leaf >> CT_BVH_COUNT_SHIFT & (CT_BVH_LEAF - 1)) + 1;
}

/* The next leaf: *n objects of bvh->object from *first on. 0: there is none. */
static inline __attribute__((always_inline)) int ct_walk_next_of(ct_walk *w, int n_lower,
                                                                 int n_upper, float before,
                                                                 size_t *first, unsigned *n) {
  float near[CT_BVH_WIDTH];
  while (w->n_open > 0) {
    uint32_t here = w->open[--w->n_open];
    if (w->at[w->n_open] > before) continue;
    while (!(here & CT_BVH_IS_LEAF)) {
      const ct_bvh_node *node = w->bvh->nodes + here;
      unsigned bits = ct_walk_enter(w, node, n_lower, n_upper, before, near);
      if (!bits) goto next;
      unsigned j = (unsigned)__builtin_ctz(bits);
      bits &= bits - 1;
      here = node->child[j];
      float at = near[j];
      int bottom = w->n_open;
      /* Keep the nearest in hand and the others on the stack, farther ones below. */
      for (; bits; bits &= bits - 1) {
        j = (unsigned)__builtin_ctz(bits);
        uint32_t child = node->child[j];
        float from = near[j];
        if (from < at) {
          uint32_t c = here;
          float f = at;
          here = child, at = from;
          child = c, from = f;
        }
        int k = w->n_open++;
        for (; k > bottom && w->at[k - 1] < from; k--) {
          w->open[k] = w->open[k - 1];
          w->at[k] = w->at[k - 1];
        }
        w->open[k] = child;
        w->at[k] = from;
      }
    }
    ct_walk_leaf(here, first, n);
    return 1;
  next:;
  }
  return 0;
}

static inline int ct_walk_next(ct_walk *w, float before, size_t *first, unsigned *n) {
  return ct_walk_next_of(w, w->n_lower, w->n_upper, before, first, n);
}

/* The leaf that begins nearest of all that are left, and in *from where: what is not visited yet
 * begins no nearer. -1: there is no room to go on. Slower a leaf than ct_walk_next, whose order is only nearly that. */
static inline int ct_walk_next_in_order(ct_walk *w, float before, size_t *first, unsigned *n,
                                        float *from) {
  float near[CT_BVH_WIDTH];
  while (w->n_open > 0) {
    int least = 0;
    for (int k = 1; k < w->n_open; k++) least = w->at[k] < w->at[least] ? k : least;
    uint32_t here = w->open[least];
    *from = w->at[least];
    w->n_open--;
    w->open[least] = w->open[w->n_open];
    w->at[least] = w->at[w->n_open];
    if (here & CT_BVH_IS_LEAF) {
      ct_walk_leaf(here, first, n);
      return 1;
    }
    const ct_bvh_node *node = w->bvh->nodes + here;
    unsigned bits = ct_walk_enter(w, node, w->n_lower, w->n_upper, before, near);
    for (; bits; bits &= bits - 1) {
      unsigned j = (unsigned)__builtin_ctz(bits);
      if (w->n_open == CT_WALK_ROOM) return -1;
      w->open[w->n_open] = node->child[j];
      w->at[w->n_open++] = near[j] > *from ? near[j] : *from;
    }
  }
  return 0;
}

/* The same for a ray, which has three limits of each kind, but for one that visits all leaves. */
static inline int ct_walk_next_on_ray(ct_walk *w, float before, size_t *first, unsigned *n) {
  if (w->n_lower != 3) return ct_walk_next_of(w, w->n_lower, w->n_upper, before, first, n);
  return ct_walk_next_of(w, 3, 3, before, first, n);
}

#endif
