/* The kernel in float. */
#include "real_f32.h"

#define CT_RUNG "f32"
#define CT_PRIMITIVES "prim_plain.inc.h"
#define CT_STACK_PER_LEVEL 4096
#define CT_TAKES_ROUNDING 1
#include "kernel.inc.h"
