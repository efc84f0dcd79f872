/* The stream in float with the compiler's vector types. */
#define FN(name) name##_f32_generic
#include "real_f32.h"

#define CT_RUNG "f32"
#define CT_LANES "lanes_generic.h"
#include "stream.inc.h"
