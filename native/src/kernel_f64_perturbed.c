/* The kernel in double that moves directions and hits by random errors (perturb.c). */
#define FN(name) name##_f64_perturbed
#include "real_f64.h"

#define CT_RUNG "f64"
#define CT_PRIMITIVES "prim_plain.inc.h"
#define CT_STACK_PER_LEVEL 4096
#define CT_TAKES_ROUNDING 0
#define CT_PERTURBED
#include "kernel.inc.h"
