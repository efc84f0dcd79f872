/* What every call into the tracer shares: settings as texts, outputs as the caller's arrays, and a
 * progress callback through which Ctrl-C arrives. */
#include <stdlib.h>
#include <string.h>

#include "core.h"

int call_take_tree(call *c, PyObject *tree) {
  if (tree == Py_None) return 0;
  const ct_tree *built = PyCapsule_GetPointer(tree, "ct_tree");
  if (!built) return -1;
  ct_options_set_tree(c->options, built);
  return 0;
}

void call_release(call *c) {
  while (c->n_buffers > 0) PyBuffer_Release(&c->buffers[--c->n_buffers]);
  ct_options_free(c->options);
  c->options = NULL;
  if (c->has_scene) scene_argument_close(&c->scene);
  c->has_scene = 0;
}

/* Settings are texts, as on the command line: ("epsilon", "1e-4"), and these names. */
static int apply_setting(call *c, const char *name, const char *value) {
  ct_fault fault = {0};
  ct_status status = CT_OK;
  if (strcmp(name, "precision") == 0)
    status = ct_options_set_precision(c->options, value, &fault);
  else if (strcmp(name, "rounding") == 0)
    status = ct_options_set_rounding(c->options, value, &fault);
  else if (strcmp(name, "instructions") == 0)
    status = ct_options_set_instructions(c->options, value, &fault);
  else if (strcmp(name, "search") == 0)
    status = ct_options_set_search(c->options, value, &fault);
  else if (strcmp(name, "tolerance") == 0) {
    double tolerance = PyOS_string_to_double(value, NULL, NULL);
    if (tolerance == -1.0 && PyErr_Occurred()) return -1;
    status = ct_options_set_tolerance(c->options, tolerance, &fault);
  } else if (strcmp(name, "threads") == 0)
    ct_options_set_threads(c->options, (unsigned)strtoul(value, NULL, 10));
  else if (strcmp(name, "effects") == 0)
    ct_options_set_effects(c->options, (unsigned)strtoul(value, NULL, 10));
  else if (strcmp(name, "ray_budget") == 0)
    ct_options_set_ray_budget(c->options, strtoull(value, NULL, 10));
  else if (strcmp(name, "jitter") == 0)
    ct_options_set_jitter(c->options, strtoull(value, NULL, 10));
  else if (strcmp(name, "row_begin") == 0)
    c->row_begin = (Py_ssize_t)strtoll(value, NULL, 10);
  else if (strcmp(name, "row_end") == 0)
    c->row_end = (Py_ssize_t)strtoll(value, NULL, 10);
  else
    status = ct_options_set(c->options, name, value, &fault);
  if (status == CT_OK) return 0;
  PyErr_Format(PyExc_ValueError, "%s: expected %s, found %s", name, fault.expected, fault.found);
  return -1;
}

int call_open(call *c, PyObject *scene, PyObject *settings, PyObject *progress) {
  if (scene_argument_open(scene, &c->scene) != 0) return -1;
  c->has_scene = 1;
  c->progress = progress == Py_None ? NULL : progress;
  c->options = ct_options_new();
  Py_ssize_t n = c->options ? PyList_Size(settings) : -1;
  if (!c->options) PyErr_NoMemory();
  for (Py_ssize_t i = 0; i < n; i++) {
    const char *name, *value;
    if (!PyArg_ParseTuple(PyList_GetItem(settings, i), "ss", &name, &value) ||
        apply_setting(c, name, value) != 0)
      n = -1;
  }
  if (n < 0) {
    call_release(c);
    return -1;
  }
  ct_options_set_rows(c->options, c->row_begin, c->row_end);
  return 0;
}

int call_open_outputs(call *c, PyObject *dict, const named_output *table, size_t n_named,
                      Py_ssize_t n_items, void *outputs) {
  for (size_t i = 0; i < n_named; i++) {
    PyObject *array = PyDict_GetItemString(dict, table[i].name);
    if (!array) continue;
    Py_buffer *buffer = &c->buffers[c->n_buffers];
    if (open_buffer(array, table[i].format, n_items * table[i].per_item, 1, table[i].name,
                    buffer) != 0)
      return -1;
    c->n_buffers++;
    memcpy((char *)outputs + table[i].offset, &buffer->buf, sizeof buffer->buf);
  }
  return 0;
}

int call_open_pixels(const call *c, PyObject *object, Py_buffer *list, const int64_t **pixels,
                     uint64_t *n_pixels) {
  *pixels = NULL;
  *n_pixels = (uint64_t)(c->scene.view.v_res * c->scene.view.h_res);
  if (object == Py_None) return 0;
  Py_ssize_t n = PyObject_Size(object);
  if (n < 0 || open_buffer(object, 'q', n, 0, "pixels", list) != 0) return -1;
  *pixels = list->buf;
  *n_pixels = (uint64_t)n;
  return 0;
}

/* Runs in the calling thread about every 50 ms. */
int call_progress(void *user, uint64_t done, uint64_t total) {
  call *c = user;
  PyEval_RestoreThread(c->thread);
  int stop = PyErr_CheckSignals() != 0;
  if (!stop && c->progress) {
    PyObject *answer =
        PyObject_CallFunction(c->progress, "d", (double)done / (double)(total ? total : 1));
    stop = answer == NULL;
    Py_XDECREF(answer);
  }
  c->thread = PyEval_SaveThread();
  return stop;
}

int call_raise(ct_status status) {
  if (status == CT_OK) return 0;
  if (status == CT_ERR_CANCELLED && PyErr_Occurred()) return -1;
  if (status == CT_ERR_MEMORY) {
    PyErr_NoMemory();
    return -1;
  }
  PyErr_SetString(status == CT_ERR_ARGUMENT ? PyExc_ValueError : PyExc_RuntimeError,
                  ct_status_text(status));
  return -1;
}
