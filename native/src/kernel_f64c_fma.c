/* The compensated kernel, for processors with the fma instruction (CMakeLists.txt, precision.c). */
#define FN(name) name##_f64c_fma
#include "kernel_f64c.c"
