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

PyObject *core_render(PyObject *module, PyObject *arguments);

#endif
