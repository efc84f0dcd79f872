/* The set-valued kernel over bounds in f128. */
#include "wide.h"

#if defined(__SIZEOF_FLOAT128__)
#include "bound_f128.h"

#define SET_NAME "f128"
#define ct_set_kernel_all_set_f128 ct_set_kernel_f128
#include "set.inc.h"
#else
typedef int ct_no_f128; /* a translation unit needs a declaration */
#endif
