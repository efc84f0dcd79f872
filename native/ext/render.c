/* Rendering from Python: outputs are the caller's arrays, the interpreter is free meanwhile. */
#include <stdlib.h>
#include <string.h>

#include "core.h"

/* The outputs by name, with the items that one pixel takes. */
static const struct {
  const char *name;
  char format;
  int per_pixel;
  size_t offset;
} outputs_table[] = {
    {"image", 'd', 3, offsetof(ct_outputs, image)},
    {"object", 'i', 1, offsetof(ct_outputs, object)},
    {"t", 'd', 1, offsetof(ct_outputs, t_world)},
    {"normal", 'd', 3, offsetof(ct_outputs, normal)},
    {"tree", 'Q', 1, offsetof(ct_outputs, tree)},
    {"rays", 'I', 1, offsetof(ct_outputs, rays)},
    {"contributions", 'd', 3 * CT_CONTRIBUTIONS, offsetof(ct_outputs, contributions)},
};

enum { N_OUTPUTS = sizeof outputs_table / sizeof *outputs_table };

typedef struct request {
  ct_outputs outputs;
  Py_buffer buffers[N_OUTPUTS];
  int n_buffers;
  PyObject *progress; /* or NULL */
  PyThreadState *thread;
} request;

static void release(request *r) {
  while (r->n_buffers > 0) PyBuffer_Release(&r->buffers[--r->n_buffers]);
}

static int open_outputs(request *r, PyObject *dict, Py_ssize_t n_pixels) {
  for (int i = 0; i < N_OUTPUTS; i++) {
    PyObject *array = PyDict_GetItemString(dict, outputs_table[i].name);
    if (!array) continue;
    if (open_buffer(array, outputs_table[i].format, n_pixels * outputs_table[i].per_pixel, 1,
                    outputs_table[i].name, &r->buffers[r->n_buffers]) != 0) {
      release(r);
      return -1;
    }
    void *items = r->buffers[r->n_buffers++].buf;
    memcpy((char *)&r->outputs + outputs_table[i].offset, &items, sizeof items);
  }
  return 0;
}

/* Settings are texts, as on the command line: ("epsilon", "1e-4"), and these four names. */
static int apply_setting(ct_options *options, const char *name, const char *value,
                         Py_ssize_t *row_begin, Py_ssize_t *row_end) {
  ct_fault fault = {0};
  ct_status status = CT_OK;
  if (strcmp(name, "precision") == 0)
    status = ct_options_set_precision(options, value, &fault);
  else if (strcmp(name, "threads") == 0)
    ct_options_set_threads(options, (unsigned)strtoul(value, NULL, 10));
  else if (strcmp(name, "effects") == 0)
    ct_options_set_effects(options, (unsigned)strtoul(value, NULL, 10));
  else if (strcmp(name, "ray_budget") == 0)
    ct_options_set_ray_budget(options, strtoull(value, NULL, 10));
  else if (strcmp(name, "row_begin") == 0)
    *row_begin = (Py_ssize_t)strtoll(value, NULL, 10);
  else if (strcmp(name, "row_end") == 0)
    *row_end = (Py_ssize_t)strtoll(value, NULL, 10);
  else
    status = ct_options_set(options, name, value, &fault);
  if (status == CT_OK) return 0;
  PyErr_Format(PyExc_ValueError, "%s: expected %s, found %s", name, fault.expected, fault.found);
  return -1;
}

static int apply_settings(ct_options *options, PyObject *list, Py_ssize_t *row_begin,
                          Py_ssize_t *row_end) {
  Py_ssize_t n = PyList_Size(list);
  if (n < 0) return -1;
  for (Py_ssize_t i = 0; i < n; i++) {
    const char *name, *value;
    if (!PyArg_ParseTuple(PyList_GetItem(list, i), "ss", &name, &value) ||
        apply_setting(options, name, value, row_begin, row_end) != 0)
      return -1;
  }
  ct_options_set_rows(options, *row_begin, *row_end);
  return 0;
}

/* Runs in the calling thread about every 50 ms: lets Ctrl-C through, and tells the progress. */
static int on_progress(void *user, uint64_t done, uint64_t total) {
  request *r = user;
  PyEval_RestoreThread(r->thread);
  int stop = PyErr_CheckSignals() != 0;
  if (!stop && r->progress) {
    PyObject *answer =
        PyObject_CallFunction(r->progress, "d", (double)done / (double)(total ? total : 1));
    stop = answer == NULL;
    Py_XDECREF(answer);
  }
  r->thread = PyEval_SaveThread();
  return stop;
}

static PyObject *raise_status(ct_status status) {
  if (status == CT_ERR_CANCELLED && PyErr_Occurred()) return NULL;
  if (status == CT_ERR_MEMORY) return PyErr_NoMemory();
  PyErr_SetString(status == CT_ERR_ARGUMENT ? PyExc_ValueError : PyExc_RuntimeError,
                  ct_status_text(status));
  return NULL;
}

PyObject *core_render(PyObject *module, PyObject *arguments) {
  PyObject *scene, *settings, *outputs, *progress;
  scene_argument argument;
  request r = {0};
  ct_stats stats = {0};
  Py_ssize_t row_begin = 0, row_end = 0;
  (void)module;
  if (!PyArg_ParseTuple(arguments, "OO!O!O", &scene, &PyList_Type, &settings, &PyDict_Type,
                        &outputs, &progress) ||
      scene_argument_open(scene, &argument) != 0)
    return NULL;
  r.progress = progress == Py_None ? NULL : progress;
  ct_options *options = ct_options_new();
  PyObject *result = NULL;
  if (!options) {
    PyErr_NoMemory();
  } else if (apply_settings(options, settings, &row_begin, &row_end) == 0) {
    Py_ssize_t rows = (row_end ? row_end : (Py_ssize_t)argument.view.v_res) - row_begin;
    if (open_outputs(&r, outputs, rows * (Py_ssize_t)argument.view.h_res) == 0) {
      r.thread = PyEval_SaveThread();
      ct_status status = ct_render(&argument.view, options, &r.outputs, on_progress, &r, &stats);
      PyEval_RestoreThread(r.thread);
      release(&r);
      if (status)
        raise_status(status);
      else
        result = Py_BuildValue("{s:K,s:K,s:K,s:K,s:I}", "primary", stats.n_primary, "shadow",
                               stats.n_shadow, "reflected", stats.n_reflected, "refracted",
                               stats.n_refracted, "threads", stats.n_threads);
    }
  }
  ct_options_free(options);
  scene_argument_close(&argument);
  return result;
}
