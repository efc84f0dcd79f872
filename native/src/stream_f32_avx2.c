/* The stream in float with AVX2. */
#define FN(name) name##_f32_avx2
#include "real_f32.h"

#define CT_RUNG "f32"
#define CT_LANES "lanes_avx2.h"
#include "stream.inc.h"
