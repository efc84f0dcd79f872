/* The double-double kernel, for processors with the fma instruction (CMakeLists.txt, precision.c). */
#define FN(name) name##_dd_fma
#include "kernel_dd.c"
