/* The tree of a frame, its own or one that outlives a call. Internal. */
#ifndef CT_TREE_H
#define CT_TREE_H

#include "frame.h"

/* Was it built for a view with the same eye, objects and lights? */
int ct_tree_fits(const ct_tree *tree, const ct_scene_view *view);
/* NULL where there were no spheres to put in. */
const ct_bvh *ct_tree_bvh(const ct_tree *tree);

/* Gives an open frame its tree, where there are objects enough for one: what a ray meets is found
 * either way. Progress as in ct_render: CT_ERR_CANCELLED. A failure closes the frame. */
ct_status ct_frame_sort(ct_frame *frame, ct_progress progress, void *user);

#endif
