/* crosstrace.native._core: the library for Python, over the limited API of 3.11. No logic here.
 *
 * Scenes go both ways as the tuple of Scene.native_view(). Arrays that the parser made come out as
 * Block objects, which hold the parsed scene alive and show one of its arrays as a buffer.
 */
#include "core.h"

#include <string.h>

/* ---- Block: one array of a parsed scene ---- */

typedef struct block {
  PyObject_HEAD
  PyObject *owner; /* a capsule that frees the ct_scene */
  void *items;
  Py_ssize_t n_bytes;
} block;

static int block_get_buffer(PyObject *self, Py_buffer *view, int flags) {
  block *b = (block *)self;
  return PyBuffer_FillInfo(view, self, b->items, b->n_bytes, 1, flags);
}

static void block_dealloc(PyObject *self) {
  PyTypeObject *type = Py_TYPE(self);
  freefunc free_object = (freefunc)PyType_GetSlot(type, Py_tp_free);
  Py_XDECREF(((block *)self)->owner);
  free_object(self);
  Py_DECREF(type);
}

static PyType_Slot block_slots[] = {{Py_bf_getbuffer, (void *)block_get_buffer},
                                    {Py_tp_dealloc, (void *)block_dealloc},
                                    {Py_tp_doc, (void *)"One array of a parsed scene, as bytes."},
                                    {0, NULL}};

static PyType_Spec block_spec = {.name = "crosstrace.native._core.Block",
                                 .basicsize = sizeof(block),
                                 .flags = Py_TPFLAGS_DEFAULT | Py_TPFLAGS_DISALLOW_INSTANTIATION,
                                 .slots = block_slots};

typedef struct module_state {
  PyObject *block_type;
} module_state;

static PyObject *new_block(PyObject *module, PyObject *owner, const void *items, size_t n_bytes) {
  module_state *state = PyModule_GetState(module);
  PyTypeObject *type = (PyTypeObject *)state->block_type;
  allocfunc allocate = (allocfunc)PyType_GetSlot(type, Py_tp_alloc);
  block *b = (block *)allocate(type, 0);
  if (!b) return NULL;
  Py_INCREF(owner);
  b->owner = owner;
  b->items = (void *)(uintptr_t)items;
  b->n_bytes = (Py_ssize_t)n_bytes;
  return (PyObject *)b;
}

static void free_scene(PyObject *capsule) {
  ct_scene_free(PyCapsule_GetPointer(capsule, "ct_scene"));
}

/* ---- Scenes ---- */

static PyObject *triple(const double t[3]) { return Py_BuildValue("(ddd)", t[0], t[1], t[2]); }

static PyObject *scene_tuple(PyObject *module, PyObject *owner, const ct_scene_view *v) {
  size_t n = v->n_objects, item = sizeof(double);
  return Py_BuildValue(
      "(iLLddNNNNLNNNNNN)", v->delivery, (long long)v->v_res, (long long)v->h_res, v->pixel_size,
      v->screen_distance, triple(v->eye), triple(v->target), triple(v->up), triple(v->background),
      (long long)v->max_depth, new_block(module, owner, v->kind, n),
      new_block(module, owner, v->color, n * 3 * item),
      new_block(module, owner, v->material, n * CT_MATERIAL_COLUMNS * item),
      new_block(module, owner, v->geometry, n * CT_GEOMETRY_COLUMNS * item), triple(v->ambient),
      new_block(module, owner, v->lights, v->n_lights * CT_LIGHT_COLUMNS * item));
}

static PyObject *core_parse(PyObject *module, PyObject *arguments) {
  Py_buffer text;
  int delivery = 0;
  ct_scene *scene = NULL;
  ct_fault fault;
  ct_status status;
  if (!PyArg_ParseTuple(arguments, "y*|i", &text, &delivery)) return NULL;
  Py_BEGIN_ALLOW_THREADS
  status = ct_scene_parse(text.buf, (size_t)text.len, delivery, &scene, &fault);
  Py_END_ALLOW_THREADS
  PyBuffer_Release(&text);
  if (status == CT_ERR_SCENE)
    return Py_BuildValue("(O(nnss))", Py_None, (Py_ssize_t)fault.line, (Py_ssize_t)fault.column,
                         fault.expected, fault.found);
  if (status == CT_ERR_MEMORY) return PyErr_NoMemory();
  if (status) {
    PyErr_SetString(PyExc_ValueError, ct_status_text(status));
    return NULL;
  }
  PyObject *owner = PyCapsule_New(scene, "ct_scene", free_scene);
  if (!owner) {
    ct_scene_free(scene);
    return NULL;
  }
  ct_scene_view view = ct_scene_data(scene);
  if (!view.lights) view.lights = view.geometry; /* no lights: any address shows 0 bytes */
  PyObject *tuple = scene_tuple(module, owner, &view);
  Py_DECREF(owner);
  return tuple ? Py_BuildValue("(NO)", tuple, Py_None) : NULL;
}

static PyObject *core_check_scene(PyObject *module, PyObject *tuple) {
  scene_argument argument;
  ct_fault fault;
  (void)module;
  if (scene_argument_open(tuple, &argument) != 0) return NULL;
  ct_status status = ct_scene_check(&argument.view, &fault);
  scene_argument_close(&argument);
  if (status == CT_OK) Py_RETURN_NONE;
  return Py_BuildValue("(sss)", fault.where, fault.expected, fault.found);
}

/* ---- Readings ---- */

static PyObject *core_readings(PyObject *module, PyObject *unused) {
  (void)module, (void)unused;
  PyObject *list = PyList_New(0);
  for (size_t i = 0; list && ct_reading_name(i); i++) {
    PyObject *row = Py_BuildValue("(sss)", ct_reading_name(i), ct_reading_default(i),
                                  ct_reading_values(i));
    if (!row || PyList_Append(list, row) != 0) Py_CLEAR(list);
    Py_XDECREF(row);
  }
  return list;
}

static PyObject *core_check_reading(PyObject *module, PyObject *arguments) {
  const char *name, *value;
  ct_fault fault;
  (void)module;
  if (!PyArg_ParseTuple(arguments, "ss", &name, &value)) return NULL;
  ct_options *options = ct_options_new();
  if (!options) return PyErr_NoMemory();
  ct_status status = ct_options_set(options, name, value, &fault);
  ct_options_free(options);
  if (status == CT_OK) Py_RETURN_NONE;
  if (status == CT_ERR_MEMORY) return PyErr_NoMemory();
  return Py_BuildValue("(ss)", fault.expected, fault.found);
}

static PyObject *list_of_names(const char *(*name_of)(size_t index)) {
  PyObject *list = PyList_New(0);
  const char *text;
  for (size_t i = 0; list && (text = name_of(i)) != NULL; i++) {
    PyObject *name = PyUnicode_FromString(text);
    if (!name || PyList_Append(list, name) != 0) Py_CLEAR(list);
    Py_XDECREF(name);
  }
  return list;
}

static PyObject *core_precisions(PyObject *module, PyObject *unused) {
  (void)module, (void)unused;
  return list_of_names(ct_precision_name);
}

static PyObject *core_instructions(PyObject *module, PyObject *unused) {
  (void)module, (void)unused;
  return list_of_names(ct_instructions_name);
}

/* ---- The module ---- */

static PyMethodDef methods[] = {
    {"parse", core_parse, METH_VARARGS,
     "parse(text, delivery=0) -> (scene tuple, None) or (None, (line, column, expected, found))"},
    {"check_scene", core_check_scene, METH_O,
     "check_scene(scene tuple) -> None or (where, expected, found)"},
    {"readings", core_readings, METH_NOARGS, "readings() -> [(name, default, values), ...]"},
    {"precisions", core_precisions, METH_NOARGS, "precisions() -> [name, ...], narrowest first"},
    {"instructions", core_instructions, METH_NOARGS,
     "instructions() -> [name, ...] of the processor's instruction sets, generic first"},
    {"check_reading", core_check_reading, METH_VARARGS,
     "check_reading(name, value) -> None or (expected, found)"},
    {"explain", core_explain, METH_VARARGS,
     "explain(scene tuple, settings, row, column, capacity, progress) -> tree; see _core.pyi"},
    {"render", core_render, METH_VARARGS,
     "render(scene tuple, settings, outputs, progress, tree=None, cells=None, side=1) -> stats; see "
     "_core.pyi"},
    {"tree", core_tree, METH_VARARGS,
     "tree(scene tuple, progress) -> its tree, for render; see _core.pyi"},
    {"intersect", core_intersect, METH_VARARGS,
     "intersect(scene tuple, settings, n, origins, directions, passes, outputs, tree=None) -> "
     "seconds; see _core.pyi"},
    {"peak_flops", core_peak_flops, METH_VARARGS, "peak_flops(instructions, seconds) -> float"},
    {"call_each", core_call_each, METH_VARARGS,
     "call_each(function, (a, b, c, d), which, stride, count); see _core.pyi"},
    {"certify", core_certify, METH_VARARGS,
     "certify(scene tuple, settings, pixels, tolerance, kappa, outputs, progress) -> counts"},
    {"perturb", core_perturb, METH_VARARGS,
     "perturb(scene tuple, settings, pixels, samples, error, seed, outputs, progress); see _core.pyi"},
    {NULL, NULL, 0, NULL}};

/* Part of an image's provenance. */
#if defined(__clang__)
#define COMPILER "clang " __clang_version__
#elif defined(__GNUC__)
#define COMPILER "gcc " __VERSION__
#else
#define COMPILER "unknown"
#endif

static int module_exec(PyObject *module) {
  module_state *state = PyModule_GetState(module);
  state->block_type = PyType_FromSpec(&block_spec);
  if (!state->block_type) return -1;
  if (PyModule_AddStringConstant(module, "compiler", COMPILER) < 0) return -1;
  return PyModule_AddStringConstant(module, "version", ct_version());
}

static int module_traverse(PyObject *module, visitproc visit, void *arg) {
  module_state *state = PyModule_GetState(module);
  if (state) Py_VISIT(state->block_type);
  return 0;
}

static int module_clear(PyObject *module) {
  module_state *state = PyModule_GetState(module);
  if (state) Py_CLEAR(state->block_type);
  return 0;
}

static PyModuleDef_Slot module_slots[] = {{Py_mod_exec, (void *)module_exec}, {0, NULL}};

static struct PyModuleDef definition = {
    PyModuleDef_HEAD_INIT, .m_name = "_core",
    .m_doc = "The native reference tracer of crosstrace.",
    .m_size = sizeof(module_state), .m_methods = methods, .m_slots = module_slots,
    .m_traverse = module_traverse, .m_clear = module_clear};

PyMODINIT_FUNC PyInit__core(void) { return PyModuleDef_Init(&definition); }
