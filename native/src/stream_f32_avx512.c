/* The stream in float with AVX-512. */
#define FN(name) name##_f32_avx512
#include "real_f32.h"

#define CT_RUNG "f32"
#define CT_LANES "lanes_avx512.h"
#include "stream.inc.h"
