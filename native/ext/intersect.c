/* Measuring from Python: nearest hits of given rays, the speed of plain arithmetic, and another
 * library's function for every record of an array. */
#include <string.h>

#include "core.h"

static int open_columns(call *c, PyObject *array, Py_ssize_t n, const char *what,
                        const double **columns) {
  Py_buffer *buffer = &c->buffers[c->n_buffers];
  if (open_buffer(array, 'd', 3 * n, 0, what, buffer) != 0) return -1;
  c->n_buffers++;
  for (int i = 0; i < 3; i++) columns[i] = (const double *)buffer->buf + i * n;
  return 0;
}

static const named_output table[] = {{"t", 'd', 1, 0}, {"object", 'q', 1, sizeof(void *)}};

PyObject *core_intersect(PyObject *module, PyObject *arguments) {
  PyObject *scene, *settings, *origin, *direction, *arrays, *tree = Py_None, *result = NULL;
  Py_ssize_t n, passes;
  double seconds = 0;
  call c = {0};
  ct_rays rays = {0};
  struct {
    double *t;
    int64_t *object;
  } out = {0};
  (void)module;
  if (!PyArg_ParseTuple(arguments, "OO!nOOnO!|O", &scene, &PyList_Type, &settings, &n, &origin,
                        &direction, &passes, &PyDict_Type, &arrays, &tree) ||
      call_open(&c, scene, settings, Py_None) != 0)
    return NULL;
  if (n < 0 || passes < 1) {
    PyErr_SetString(PyExc_ValueError, "expected a number of rays and at least one pass");
  } else if (call_take_tree(&c, tree) == 0 &&
             open_columns(&c, origin, n, "origin", rays.origin) == 0 &&
             open_columns(&c, direction, n, "direction", rays.direction) == 0 &&
             call_open_outputs(&c, arrays, table, 2, n, &out) == 0) {
    rays.n = (size_t)n;
    c.thread = PyEval_SaveThread();
    ct_status status = ct_intersect(&c.scene.view, c.options, &rays, (size_t)passes, out.t,
                                    out.object, &seconds);
    PyEval_RestoreThread(c.thread);
    if (call_raise(status) == 0) result = PyFloat_FromDouble(seconds);
  }
  call_release(&c);
  return result;
}

PyObject *core_peak_flops(PyObject *module, PyObject *arguments) {
  const char *most;
  double seconds, flops = 0;
  ct_fault fault;
  (void)module;
  if (!PyArg_ParseTuple(arguments, "sd", &most, &seconds)) return NULL;
  ct_options *options = ct_options_new();
  if (!options) return PyErr_NoMemory();
  ct_status status = ct_options_set_instructions(options, most, &fault);
  if (status == CT_OK) {
    Py_BEGIN_ALLOW_THREADS
    flops = ct_peak_flops(options, seconds);
    Py_END_ALLOW_THREADS
  }
  ct_options_free(options);
  if (status == CT_OK) return PyFloat_FromDouble(flops);
  PyErr_Format(PyExc_ValueError, "instructions: expected %s, found %s", fault.expected,
               fault.found);
  return NULL;
}

typedef void (*any_function)(void *, void *, void *, void *);

PyObject *core_call_each(PyObject *module, PyObject *arguments) {
  Py_ssize_t function, a[4], which, stride, count;
  (void)module;
  if (!PyArg_ParseTuple(arguments, "n(nnnn)nnn", &function, a, a + 1, a + 2, a + 3, &which, &stride,
                        &count))
    return NULL;
  if (!function || which < 0 || which > 3) {
    PyErr_SetString(PyExc_ValueError, "expected a function and the number of an argument");
    return NULL;
  }
  any_function f;
  memcpy(&f, &function, sizeof f);
  Py_BEGIN_ALLOW_THREADS
  for (Py_ssize_t i = 0; i < count; i++, a[which] += stride)
    f((void *)a[0], (void *)a[1], (void *)a[2], (void *)a[3]);
  Py_END_ALLOW_THREADS
  Py_RETURN_NONE;
}
