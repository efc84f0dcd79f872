/* The kernel in the x87's long double, where there is one. */
#include <float.h>

#if LDBL_MANT_DIG == 64
#include "real_f80.h"

#define CT_RUNG "f80"
#define CT_PRIMITIVES "prim_plain.inc.h"
#define CT_STACK_PER_LEVEL 6144
#define CT_TAKES_ROUNDING 1
#include "kernel.inc.h"
#else
typedef int ct_no_f80; /* a translation unit may not be empty */
#endif
