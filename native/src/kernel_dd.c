/* The kernel in double-double. */
#include "real_dd.h"

#define CT_RUNG "dd"
#define CT_PRIMITIVES "prim_plain.inc.h"
#define CT_STACK_PER_LEVEL 6144
#define CT_TAKES_ROUNDING 0 /* error-free transformations need rounding to nearest */
#include "kernel.inc.h"
