/* The kernel in double. */
#include <float.h>

#include "real_f64.h"

#define REAL_UNIT (DBL_EPSILON / 2)
#define CT_PRIMITIVES "prim_plain.inc.h"
#include "kernel.inc.h"
