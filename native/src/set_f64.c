/* The set-valued kernel over bounds in f64. */
#include "bound_f64.h"

#define SET_NAME "f64"
#define ct_set_kernel_all_set_f64 ct_set_kernel_f64
#include "set.inc.h"
