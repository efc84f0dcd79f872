/* A tree that outlives a call, for scenes that are rendered in several. */
#include "tree.h"

#include <stdlib.h>
#include <string.h>

#include "frame.h"
#include "machine.h"

struct ct_tree {
  ct_bvh *bvh;
  /* What it was built from: the arrays' addresses, and the eye, which may lie on a sphere. */
  const uint8_t *kind;
  const double *geometry, *lights;
  size_t n_objects, n_lights;
  double eye[3];
};

ct_status ct_tree_new(const ct_scene_view *view, ct_progress progress, void *user,
                      ct_tree **out) {
  if (!view || !out) return CT_ERR_ARGUMENT;
  *out = NULL;
  ct_tree *tree = calloc(1, sizeof *tree);
  ct_options *options = ct_options_new();
  ct_status status = tree && options ? CT_OK : CT_ERR_MEMORY;
  ct_machine_state caller = ct_machine_enter();
  if (!status) {
    ct_frame frame;
    *tree = (ct_tree){.kind = view->kind, .geometry = view->geometry, .lights = view->lights,
                      .n_objects = view->n_objects, .n_lights = view->n_lights};
    memcpy(tree->eye, view->eye, sizeof tree->eye);
    status = ct_frame_open(&frame, view, options);
    if (!status) {
      status = ct_frame_build(&frame, 1, progress, user, &tree->bvh);
      ct_frame_close(&frame);
    }
  }
  ct_machine_leave(caller);
  ct_options_free(options);
  if (status) {
    ct_tree_free(tree);
    return status;
  }
  *out = tree;
  return CT_OK;
}

void ct_tree_free(ct_tree *tree) {
  if (!tree) return;
  ct_bvh_close(tree->bvh);
  free(tree);
}

int ct_tree_fits(const ct_tree *tree, const ct_scene_view *view) {
  return tree && tree->kind == view->kind && tree->geometry == view->geometry &&
         tree->lights == view->lights && tree->n_objects == view->n_objects &&
         tree->n_lights == view->n_lights && memcmp(tree->eye, view->eye, sizeof tree->eye) == 0;
}

const ct_bvh *ct_tree_bvh(const ct_tree *tree) { return tree->bvh; }
