/* The set-valued kernel in double-double, for processors with the fma instruction (certify.c). */
#define CT_SET_DD_FMA
#define SET_FN(name) name##_set_dd_fma
#define ct_set_kernel_all_set_dd_fma ct_set_kernel_dd_fma
#include "set_dd.c"
