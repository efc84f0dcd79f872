/* The kernel in double. */
#include "real_f64.h"

#define CT_RUNG "f64"
#define CT_PRIMITIVES "prim_plain.inc.h"
#define CT_STACK_PER_LEVEL 4096
#define CT_TAKES_ROUNDING 1
#include "kernel.inc.h"
