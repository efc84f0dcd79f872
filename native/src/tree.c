/* The tree of a frame: built for one call, or outliving it for scenes rendered in several. */
#include "tree.h"

#include <stdlib.h>
#include <string.h>

#include "machine.h"
#include "parallel.h"
#include "stream.h"

struct ct_tree {
  ct_bvh *bvh;
  /* What it was built from: the arrays' addresses, and the eye, which may lie on a sphere. */
  const uint8_t *kind;
  const double *geometry, *lights;
  size_t n_objects, n_lights;
  double eye[3];
};

/* From so many spheres on the tree pays, measured on clouds of spheres: 16 to 20 where rays are traced
 * one by one, 48 to 64 where streams ask an object for a vector of them. */
enum { TREE_FOR_RAYS = 20, TREE_FOR_STREAMS = 64 };

typedef struct sorting {
  const ct_frame *frame;
  size_t least;
  ct_bvh *bvh;
  atomic_int stop;
} sorting;

static void sort_in_thread(void *job, void *state, uint64_t begin, uint64_t end) {
  sorting *s = job;
  (void)state, (void)begin, (void)end;
  const ct_frame *frame = s->frame;
  size_t n = frame->view.n_objects;
  /* The tests of these depend on more than the ray. */
  uint8_t *is_apart = malloc(n + 1);
  ct_status status = CT_ERR_MEMORY;
  if (is_apart) {
    memcpy(is_apart, frame->eye_on, n);
    for (size_t k = 0; k < frame->n_lights_on; k++) is_apart[frame->lights_on[k].object] = 1;
    status = ct_bvh_open(&frame->view, is_apart, s->least, &s->stop, &s->bvh);
  }
  free(is_apart);
  int running = CT_OK;
  if (status) atomic_compare_exchange_strong(&s->stop, &running, (int)status);
}

/* Builds the tree of an open frame, of at least so many spheres; *out is NULL otherwise. In a thread
 * of its own, so that the calling one can be asked to stop. */
static ct_status build(const ct_frame *frame, size_t least, ct_progress progress, void *user,
                       ct_bvh **out) {
  sorting s = {.frame = frame, .least = least};
  ct_work work = {.run = sort_in_thread, .job = &s, .n_items = 1, .chunk = 1,
                  .stack_bytes = (size_t)2 << 20, .stop = &s.stop};
  ct_status status = ct_parallel(&work, 1, progress, user, NULL);
  if (status) {
    ct_bvh_close(s.bvh);
    s.bvh = NULL;
  }
  *out = s.bvh;
  return status;
}

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
      status = build(&frame, 1, progress, user, &tree->bvh);
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

ct_status ct_frame_sort(ct_frame *frame, ct_progress progress, void *user) {
  const ct_options *options = frame->options;
  size_t n = frame->view.n_objects, least = 1;
  if (options->search == CT_SEARCH_SCAN) return CT_OK;
  if (options->search == CT_SEARCH_AUTO)
    least = ct_stream_for(options) ? TREE_FOR_STREAMS : TREE_FOR_RAYS;
  if (n < least) return CT_OK;
  if (ct_tree_fits(options->tree, &frame->view)) {
    frame->bvh = ct_tree_bvh(options->tree);
    if (frame->bvh && frame->bvh->n_objects < least) frame->bvh = NULL;
    return CT_OK;
  }
  ct_status status = build(frame, least, progress, user, &frame->own_bvh);
  frame->bvh = frame->own_bvh;
  if (status) ct_frame_close(frame);
  return status;
}
