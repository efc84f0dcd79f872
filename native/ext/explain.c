/* The ray tree of a pixel from Python: a list of tuples, one a ray. */
#include <stdlib.h>

#include "core.h"

static PyObject *triple(const double v[3]) { return Py_BuildValue("(ddd)", v[0], v[1], v[2]); }

static PyObject *ray_tuple(const ct_ray_record *r) {
  return Py_BuildValue(
      "(iLLLLiLiiddddNNNNNNNNNd)", (int)r->kind, (long long)r->parent, (long long)r->depth,
      (long long)r->object, (long long)r->light, (int)r->margin_decision,
      (long long)r->margin_object, (int)r->inside, (int)r->total, r->weight, r->t_world,
      r->light_distance, r->margin, triple(r->origin), triple(r->direction), triple(r->point),
      triple(r->normal), triple(r->color), triple(r->base), triple(r->diffuse),
      triple(r->specular), triple(r->unsent), r->clearance);
}

static PyObject *ray_list(const ct_ray_record *records, size_t n) {
  PyObject *list = PyList_New(0);
  for (size_t i = 0; list && i < n; i++) {
    PyObject *ray = ray_tuple(&records[i]);
    if (!ray || PyList_Append(list, ray) != 0) Py_CLEAR(list);
    Py_XDECREF(ray);
  }
  return list;
}

PyObject *core_explain(PyObject *module, PyObject *arguments) {
  PyObject *scene, *settings, *progress, *rays = NULL;
  call c = {0};
  long long row, column;
  Py_ssize_t capacity;
  ct_pixel_tree tree = {0};
  (void)module;
  if (!PyArg_ParseTuple(arguments, "OO!LLnO", &scene, &PyList_Type, &settings, &row, &column,
                        &capacity, &progress) ||
      call_open(&c, scene, settings, progress) != 0)
    return NULL;
  ct_ray_record *records = calloc(capacity > 0 ? (size_t)capacity : 1, sizeof *records);
  if (records) {
    c.thread = PyEval_SaveThread();
    ct_status status = ct_explain(&c.scene.view, c.options, row, column, records,
                                  capacity > 0 ? (size_t)capacity : 0, &tree, call_progress, &c);
    PyEval_RestoreThread(c.thread);
    size_t n = capacity > 0 && tree.n_rays > (uint64_t)capacity ? (size_t)capacity
                                                                : (size_t)tree.n_rays;
    if (call_raise(status) == 0) rays = ray_list(records, capacity > 0 ? n : 0);
    free(records);
  } else {
    PyErr_NoMemory();
  }
  call_release(&c);
  if (!rays) return NULL;
  return Py_BuildValue("(NKKN)", rays, (unsigned long long)tree.n_rays,
                       (unsigned long long)tree.tree, triple(tree.color));
}
