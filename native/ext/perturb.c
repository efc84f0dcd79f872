/* Perturbed renders from Python. */
#include <stddef.h>

#include "core.h"

PyObject *core_perturb(PyObject *module, PyObject *arguments) {
  PyObject *scene, *settings, *pixels, *arrays, *progress, *result = NULL;
  unsigned long long n_samples, seed;
  call c = {0};
  Py_buffer list = {0};
  ct_samples outputs = {0};
  ct_perturb_request request = {0};
  (void)module;
  if (!PyArg_ParseTuple(arguments, "OO!OKdKO!O", &scene, &PyList_Type, &settings, &pixels,
                        &n_samples, &request.error, &seed, &PyDict_Type, &arrays, &progress))
    return NULL;
  if (n_samples > 1 << 24) {
    PyErr_SetString(PyExc_ValueError, "samples: expected at most 2^24");
    return NULL;
  }
  if (call_open(&c, scene, settings, progress) != 0) return NULL;
  if (call_open_pixels(&c, pixels, &list, &request.pixels, &request.n_pixels) != 0) {
    call_release(&c);
    return NULL;
  }
  request.n_samples = n_samples;
  request.seed = seed;
  const named_output table[] = {
      {"colors", 'd', 3 * (int)n_samples, offsetof(ct_samples, colors)},
      {"trees", 'Q', (int)n_samples, offsetof(ct_samples, trees)},
  };
  if (call_open_outputs(&c, arrays, table, sizeof table / sizeof *table,
                        (Py_ssize_t)request.n_pixels, &outputs) == 0) {
    c.thread = PyEval_SaveThread();
    ct_status status =
        ct_perturb(&c.scene.view, c.options, &request, &outputs, call_progress, &c);
    PyEval_RestoreThread(c.thread);
    if (call_raise(status) == 0) result = Py_NewRef(Py_None);
  }
  if (pixels != Py_None) PyBuffer_Release(&list);
  call_release(&c);
  return result;
}
