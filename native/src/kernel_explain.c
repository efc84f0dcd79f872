/* The kernel in double that records the rays of a pixel: the text of kernel_f64.c with its hooks. */
#define FN(name) name##_explain
#include "real_f64.h"

#define CT_RUNG "f64"
#define CT_PRIMITIVES "prim_plain.inc.h"
#define CT_STACK_PER_LEVEL 8192
#define CT_TAKES_ROUNDING 0
#define CT_RECORDS
#include "kernel.inc.h"
#include "record_margin.inc.h"
#include "record.inc.h"
