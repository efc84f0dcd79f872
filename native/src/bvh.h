/* A tree of boxes over the spheres of a frame, eight children a node, for scenes with too many
 * objects to ask each. Internal.
 *
 * The tree only says which objects a ray need not be asked about; whether it hits one of the others
 * is for the kernel's own test. So every kernel finds with the tree what it finds without it, to
 * the last bit, if no object is passed over that the kernel would have said to be hit. That is what
 * the slack of a walk (bvh_walk.h) is for.
 */
#ifndef CT_BVH_H
#define CT_BVH_H

#include <stdatomic.h>
#include <stddef.h>
#include <stdint.h>

#include "crosstrace.h"

enum { CT_BVH_WIDTH = 8, CT_BVH_LEAF = 8 };
/* A reference to a child: a node's index; or this bit, how many objects less one, and the first. */
#define CT_BVH_IS_LEAF UINT32_C(0x80000000)
enum { CT_BVH_COUNT_SHIFT = 28 };
#define CT_BVH_MOST_OBJECTS (UINT32_C(1) << CT_BVH_COUNT_SHIFT)

/* Levels of the tree, at most: the build sees to it. */
enum { CT_BVH_DEPTH = 64 };

typedef struct ct_bvh_node {
  /* Boxes of the children relative to `middle`, rounded outward: the low x of all, then low y and
   * z, then the high ones. A child that is none has an empty box. */
  float bound[6][CT_BVH_WIDTH];
  uint32_t child[CT_BVH_WIDTH];
} ct_bvh_node;

typedef struct ct_bvh {
  ct_bvh_node *nodes; /* the root first */
  size_t n_nodes;
  uint32_t *object; /* of the leaves, n_leaves_objects of them */
  size_t n_objects;
  /* Those that are in no leaf, in rising order: planes, spheres that the eye or a light lies on, and
   * a few whose size is out of all proportion to the others'. */
  uint32_t *apart;
  size_t n_apart;
  double middle[3];
  double reach; /* no box goes farther than this from the middle along an axis */
  double extent; /* nor than this from the world's origin */
  double least_radius;
} ct_bvh;

/* Builds the tree; is_apart says which spheres are to be kept out of it. *out stays NULL where there
 * is no memory (CT_ERR_MEMORY), or where there are fewer than `least` spheres to put in, or numbers
 * outside the range in which the slack is known to be enough. Where *stop is set, a ct_status, it
 * is returned soon. */
ct_status ct_bvh_open(const ct_scene_view *view, const uint8_t *is_apart, size_t least,
                      const atomic_int *stop, ct_bvh **out);
void ct_bvh_close(ct_bvh *bvh);

#endif
