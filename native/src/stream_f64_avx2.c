/* The stream in double with AVX2. */
#define FN(name) name##_f64_avx2
#include "real_f64.h"

#define CT_RUNG "f64"
#define CT_LANES "lanes_avx2.h"
#include "stream.inc.h"
