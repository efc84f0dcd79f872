/* Rendering from Python: outputs are the caller's arrays, the interpreter is free meanwhile. */
#include <stddef.h>

#include "core.h"

static const named_output table[] = {
    {"image", 'd', 3, offsetof(ct_outputs, image)},
    {"object", 'i', 1, offsetof(ct_outputs, object)},
    {"t", 'd', 1, offsetof(ct_outputs, t_world)},
    {"normal", 'd', 3, offsetof(ct_outputs, normal)},
    {"tree", 'Q', 1, offsetof(ct_outputs, tree)},
    {"rays", 'I', 1, offsetof(ct_outputs, rays)},
    {"contributions", 'd', 3 * CT_CONTRIBUTIONS, offsetof(ct_outputs, contributions)},
    {"image_low", 'd', 3, offsetof(ct_outputs, image_low)},
};

PyObject *core_render(PyObject *module, PyObject *arguments) {
  PyObject *scene, *settings, *arrays, *progress, *tree = Py_None, *result = NULL;
  call c = {0};
  ct_outputs outputs = {0};
  ct_stats stats = {0};
  (void)module;
  if (!PyArg_ParseTuple(arguments, "OO!O!O|O", &scene, &PyList_Type, &settings, &PyDict_Type,
                        &arrays, &progress, &tree) ||
      call_open(&c, scene, settings, progress) != 0)
    return NULL;
  if (tree != Py_None) {
    const ct_tree *built = PyCapsule_GetPointer(tree, "ct_tree");
    if (!built) {
      call_release(&c);
      return NULL;
    }
    ct_options_set_tree(c.options, built);
  }
  Py_ssize_t rows = (c.row_end ? c.row_end : (Py_ssize_t)c.scene.view.v_res) - c.row_begin;
  if (call_open_outputs(&c, arrays, table, sizeof table / sizeof *table,
                        rows * (Py_ssize_t)c.scene.view.h_res, &outputs) == 0) {
    c.thread = PyEval_SaveThread();
    ct_status status = ct_render(&c.scene.view, c.options, &outputs, call_progress, &c, &stats);
    PyEval_RestoreThread(c.thread);
    if (call_raise(status) == 0)
      result = Py_BuildValue("{s:K,s:K,s:K,s:K,s:I}", "primary", stats.n_primary, "shadow",
                             stats.n_shadow, "reflected", stats.n_reflected, "refracted",
                             stats.n_refracted, "threads", stats.n_threads);
  }
  call_release(&c);
  return result;
}

static void free_tree(PyObject *capsule) {
  ct_tree_free(PyCapsule_GetPointer(capsule, "ct_tree"));
}

PyObject *core_tree(PyObject *module, PyObject *tuple) {
  scene_argument scene;
  ct_tree *tree = NULL;
  ct_status status;
  (void)module;
  if (scene_argument_open(tuple, &scene) != 0) return NULL;
  Py_BEGIN_ALLOW_THREADS
  status = ct_tree_new(&scene.view, &tree);
  Py_END_ALLOW_THREADS
  scene_argument_close(&scene);
  if (call_raise(status) != 0) return NULL;
  PyObject *capsule = PyCapsule_New(tree, "ct_tree", free_tree);
  if (!capsule) ct_tree_free(tree);
  return capsule;
}
