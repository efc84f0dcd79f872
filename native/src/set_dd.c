/* The set-valued kernel over bounds in dd. */
#include "bound_dd.h"

#define SET_NAME "dd"
#if !defined(CT_SET_DD_FMA)
#define ct_set_kernel_all_set_dd ct_set_kernel_dd
#endif
#include "set.inc.h"
