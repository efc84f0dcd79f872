/* The set-valued kernel over bounds in dd. */
#include "bound_dd.h"

#define SET_NAME "dd"
#define ct_set_kernel_all_set_dd ct_set_kernel_dd
#include "set.inc.h"
