/* The kernel in double with compensated primitives. */
#ifndef FN
#define FN(name) name##_f64c
#endif
#include "real_f64.h"

#define CT_RUNG "f64c"
#define CT_PRIMITIVES "prim_comp.inc.h"
#define CT_STACK_PER_LEVEL 4096
#define CT_TAKES_ROUNDING 0 /* error-free transformations need rounding to nearest */
#include "kernel.inc.h"
