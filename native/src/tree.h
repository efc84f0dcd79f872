/* A tree that outlives a call. Internal. */
#ifndef CT_TREE_H
#define CT_TREE_H

#include "bvh.h"

/* Was it built for a view with the same eye, objects and lights? */
int ct_tree_fits(const ct_tree *tree, const ct_scene_view *view);
/* NULL where there were no spheres to put in. */
const ct_bvh *ct_tree_bvh(const ct_tree *tree);

#endif
