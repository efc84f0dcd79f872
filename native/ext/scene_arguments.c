/* Reads a Scene's tuple of numbers and arrays into a view, without copying the arrays. */
#include <string.h>

#include "core.h"

static const char *format_of(const Py_buffer *buffer) {
  const char *format = buffer->format ? buffer->format : "B";
  return *format == '<' || *format == '=' || *format == '@' ? format + 1 : format;
}

/* Integers of the same width go by several letters: numpy says 'l' where C says 'q'. */
static int same_format(char wanted, const char *found) {
  if (found[0] == 0 || found[1] != 0) return 0;
  switch (wanted) {
    case 'Q': return strchr("QL", *found) && (*found == 'Q' || sizeof(long) == 8);
    case 'q': return strchr("ql", *found) && (*found == 'q' || sizeof(long) == 8);
    default: return *found == wanted;
  }
}

int open_buffer(PyObject *object, char format, Py_ssize_t n, int writable, const char *what,
                Py_buffer *buffer) {
  int flags = PyBUF_C_CONTIGUOUS | PyBUF_FORMAT | (writable ? PyBUF_WRITABLE : 0);
  if (PyObject_GetBuffer(object, buffer, flags) != 0) return -1;
  if (same_format(format, format_of(buffer)) && buffer->len == n * buffer->itemsize) return 0;
  PyErr_Format(PyExc_ValueError, "%s: expected %zd items of format '%c', found %zd bytes of '%s'",
               what, n, format, buffer->len, format_of(buffer));
  PyBuffer_Release(buffer);
  return -1;
}

void scene_argument_close(scene_argument *argument) {
  while (argument->n_buffers > 0) PyBuffer_Release(&argument->buffers[--argument->n_buffers]);
}

static const void *borrow(scene_argument *a, PyObject *object, char format, Py_ssize_t n,
                          const char *what) {
  Py_buffer *buffer = &a->buffers[a->n_buffers];
  if (open_buffer(object, format, n, 0, what, buffer) != 0) return NULL;
  a->n_buffers++;
  return buffer->buf;
}

static int copy_triple(PyObject *object, const char *what, double out[3]) {
  Py_buffer buffer;
  if (open_buffer(object, 'd', 3, 0, what, &buffer) != 0) return -1;
  memcpy(out, buffer.buf, 3 * sizeof *out);
  PyBuffer_Release(&buffer);
  return 0;
}

int scene_argument_open(PyObject *tuple, scene_argument *a) {
  PyObject *eye, *target, *up, *background, *kind, *color, *material, *geometry, *ambient, *lights;
  long long v_res, h_res, max_depth;
  ct_scene_view *v = &a->view;
  memset(a, 0, sizeof *a);
  if (!PyTuple_Check(tuple)) {
    PyErr_SetString(PyExc_TypeError, "expected the tuple of Scene.native_view()");
    return -1;
  }
  if (!PyArg_ParseTuple(tuple, "iLLddOOOOLOOOOOO", &v->delivery, &v_res, &h_res, &v->pixel_size,
                        &v->screen_distance, &eye, &target, &up, &background, &max_depth, &kind,
                        &color, &material, &geometry, &ambient, &lights))
    return -1;
  v->v_res = v_res;
  v->h_res = h_res;
  v->max_depth = max_depth;
  Py_ssize_t n = PyObject_Size(kind), m = n < 0 ? -1 : PyObject_Size(lights);
  if (n < 0 || m < 0) return -1;
  v->n_objects = (size_t)n;
  v->n_lights = (size_t)m;
  if (copy_triple(eye, "eye", v->eye) || copy_triple(target, "target", v->target) ||
      copy_triple(up, "up", v->up) || copy_triple(background, "background", v->background) ||
      copy_triple(ambient, "ambient", v->ambient))
    return -1;
  if (!(v->kind = borrow(a, kind, 'B', n, "kind")) ||
      !(v->color = borrow(a, color, 'd', 3 * n, "color")) ||
      !(v->material = borrow(a, material, 'd', CT_MATERIAL_COLUMNS * n, "material")) ||
      !(v->geometry = borrow(a, geometry, 'd', CT_GEOMETRY_COLUMNS * n, "geometry")) ||
      !(v->lights = borrow(a, lights, 'd', CT_LIGHT_COLUMNS * m, "lights"))) {
    scene_argument_close(a);
    return -1;
  }
  return 0;
}
