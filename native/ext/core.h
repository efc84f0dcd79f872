/* The extension module's own declarations. */
#ifndef CT_EXT_CORE_H
#define CT_EXT_CORE_H

#define PY_SSIZE_T_CLEAN
#include <Python.h>

#include "crosstrace.h"

/* A scene given as the tuple of Scene.native_view(), its arrays borrowed until it is released. */
typedef struct scene_argument {
  ct_scene_view view;
  Py_buffer buffers[9];
  int n_buffers;
} scene_argument;

/* 0, or -1 with a Python exception set (then nothing is held). */
int scene_argument_open(PyObject *tuple, scene_argument *argument);
void scene_argument_close(scene_argument *argument);

/* A C-contiguous buffer of exactly n items of one struct-module format, such as 'd'. */
int open_buffer(PyObject *object, char format, Py_ssize_t n, int writable, const char *what,
                Py_buffer *buffer);

enum { CALL_MAX_OUTPUTS = 16 };

/* One call into the tracer. Fill with zeros, then call_open; call_release gives all back. */
typedef struct call {
  scene_argument scene;
  int has_scene;
  ct_options *options;
  Py_ssize_t row_begin, row_end;
  Py_buffer buffers[CALL_MAX_OUTPUTS];
  int n_buffers;
  PyObject *progress; /* borrowed, or NULL */
  PyThreadState *thread;
} call;

/* An output array by name: the items of one pixel, and its pointer's place in a struct. */
typedef struct named_output {
  const char *name;
  char format;
  int per_item;
  size_t offset;
} named_output;

/* 0, or -1 with a Python exception set; call_open then holds nothing. */
int call_open(call *c, PyObject *scene, PyObject *settings, PyObject *progress);
int call_open_outputs(call *c, PyObject *dict, const named_output *table, size_t n_named,
                      Py_ssize_t n_items, void *outputs);
/* The pixels asked for: an array of int64, held in *list until PyBuffer_Release, or None for all
 * (*pixels is then NULL and nothing is held). */
int call_open_pixels(const call *c, PyObject *object, Py_buffer *list, const int64_t **pixels,
                     uint64_t *n_pixels);
/* What core_tree made, or None: the call then builds its own where it takes one. */
int call_take_tree(call *c, PyObject *tree);
void call_release(call *c);
int call_progress(void *user, uint64_t done, uint64_t total);
int call_raise(ct_status status);

PyObject *core_certify(PyObject *module, PyObject *arguments);
PyObject *core_perturb(PyObject *module, PyObject *arguments);
PyObject *core_explain(PyObject *module, PyObject *arguments);
PyObject *core_call_each(PyObject *module, PyObject *arguments);
PyObject *core_intersect(PyObject *module, PyObject *arguments);
PyObject *core_peak_flops(PyObject *module, PyObject *arguments);
PyObject *core_render(PyObject *module, PyObject *arguments);
PyObject *core_tree(PyObject *module, PyObject *arguments);

#endif
