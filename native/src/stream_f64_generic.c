/* The stream in double with the compiler's vector types. */
#define FN(name) name##_f64_generic
#include "real_f64.h"

#define CT_RUNG "f64"
#define CT_LANES "lanes_generic.h"
#include "stream.inc.h"
