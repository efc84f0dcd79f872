/* The stream in double with AVX-512. */
#define FN(name) name##_f64_avx512
#include "real_f64.h"

#define CT_RUNG "f64"
#define CT_LANES "lanes_avx512.h"
#include "stream.inc.h"
