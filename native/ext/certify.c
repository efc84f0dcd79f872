/* Certification from Python. */
#include <stddef.h>

#include "core.h"

static const named_output table[] = {
    {"lo", 'd', 3, offsetof(ct_enclosures, lo)},
    {"hi", 'd', 3, offsetof(ct_enclosures, hi)},
    {"pixel_class", 'B', 1, offsetof(ct_enclosures, pixel_class)},
    {"level", 'B', 1, offsetof(ct_enclosures, level)},
    {"decision", 'B', 1, offsetof(ct_enclosures, decision)},
    {"depth", 'i', 1, offsetof(ct_enclosures, depth)},
    {"object", 'i', 1, offsetof(ct_enclosures, object)},
    {"n_alternatives", 'B', 1, offsetof(ct_enclosures, n_alternatives)},
    {"alternatives", 'd', CT_ALTERNATIVES * 6, offsetof(ct_enclosures, alternatives)},
};

PyObject *core_certify(PyObject *module, PyObject *arguments) {
  PyObject *scene, *settings, *pixels, *arrays, *progress, *result = NULL;
  call c = {0};
  Py_buffer list = {0};
  ct_enclosures outputs = {0};
  ct_certify_request request = {0};
  ct_certify_stats stats = {0};
  (void)module;
  if (!PyArg_ParseTuple(arguments, "OO!OddO!O", &scene, &PyList_Type, &settings, &pixels,
                        &request.tolerance, &request.kappa, &PyDict_Type, &arrays, &progress) ||
      call_open(&c, scene, settings, progress) != 0)
    return NULL;
  if (call_open_pixels(&c, pixels, &list, &request.pixels, &request.n_pixels) != 0) {
    call_release(&c);
    return NULL;
  }
  if (call_open_outputs(&c, arrays, table, sizeof table / sizeof *table,
                        (Py_ssize_t)request.n_pixels, &outputs) == 0) {
    c.thread = PyEval_SaveThread();
    ct_status status =
        ct_certify(&c.scene.view, c.options, &request, &outputs, call_progress, &c, &stats);
    PyEval_RestoreThread(c.thread);
    if (call_raise(status) == 0)
      result = Py_BuildValue("{s:K,s:K,s:K}", "double", stats.n_closed[0], "double-double",
                             stats.n_closed[1], "float128", stats.n_closed[2]);
  }
  if (pixels != Py_None) PyBuffer_Release(&list);
  call_release(&c);
  return result;
}
