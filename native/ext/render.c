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
  PyObject *scene, *settings, *arrays, *progress, *result = NULL;
  PyObject *tree = Py_None, *squares = Py_None;
  long long side = 1;
  call c = {0};
  ct_outputs outputs = {0};
  ct_stats stats = {0};
  Py_buffer list = {0};
  const int64_t *cells = NULL;
  uint64_t n_cells = 0;
  (void)module;
  if (!PyArg_ParseTuple(arguments, "OO!O!O|OOL", &scene, &PyList_Type, &settings, &PyDict_Type,
                        &arrays, &progress, &tree, &squares, &side) ||
      call_open(&c, scene, settings, progress) != 0)
    return NULL;
  if (call_take_tree(&c, tree) != 0 ||
      call_open_pixels(&c, squares, &list, &cells, &n_cells) != 0) {
    call_release(&c);
    return NULL;
  }
  Py_ssize_t rows = (c.row_end ? c.row_end : (Py_ssize_t)c.scene.view.v_res) - c.row_begin;
  Py_ssize_t n_items = cells ? (Py_ssize_t)n_cells * (Py_ssize_t)(side * side)
                             : rows * (Py_ssize_t)c.scene.view.h_res;
  if (side < 1 || side > CT_LARGEST_CELL) {
    PyErr_Format(PyExc_ValueError, "side: expected 1 to %d, found %lld", CT_LARGEST_CELL, side);
  } else if (call_open_outputs(&c, arrays, table, sizeof table / sizeof *table, n_items,
                               &outputs) == 0) {
    const ct_scene_view *view = &c.scene.view;
    c.thread = PyEval_SaveThread();
    ct_status status = cells ? ct_render_cells(view, c.options, cells, n_cells, side, &outputs,
                                               call_progress, &c, &stats)
                             : ct_render(view, c.options, &outputs, call_progress, &c, &stats);
    PyEval_RestoreThread(c.thread);
    if (call_raise(status) == 0)
      result = Py_BuildValue("{s:K,s:K,s:K,s:K,s:I}", "primary", stats.n_primary, "shadow",
                             stats.n_shadow, "reflected", stats.n_reflected, "refracted",
                             stats.n_refracted, "threads", stats.n_threads);
  }
  if (cells) PyBuffer_Release(&list);
  call_release(&c);
  return result;
}

static void free_tree(PyObject *capsule) {
  ct_tree_free(PyCapsule_GetPointer(capsule, "ct_tree"));
  Py_XDECREF(PyCapsule_GetContext(capsule));
}

PyObject *core_tree(PyObject *module, PyObject *arguments) {
  PyObject *scene, *progress, *settings = PyList_New(0);
  call c = {0};
  ct_tree *tree = NULL;
  ct_status status = CT_ERR_MEMORY;
  (void)module;
  int is_open = settings && PyArg_ParseTuple(arguments, "OO", &scene, &progress) &&
                call_open(&c, scene, settings, progress) == 0;
  Py_XDECREF(settings);
  if (!is_open) return NULL;
  c.thread = PyEval_SaveThread();
  status = ct_tree_new(&c.scene.view, call_progress, &c, &tree);
  PyEval_RestoreThread(c.thread);
  call_release(&c);
  if (call_raise(status) != 0) return NULL;
  PyObject *capsule = PyCapsule_New(tree, "ct_tree", free_tree);
  if (!capsule)
    ct_tree_free(tree);
  else /* the tree is known by its arrays' addresses: nothing else may come to stand there */
    PyCapsule_SetContext(capsule, Py_NewRef(scene));
  return capsule;
}
