/* The certified streams: AVX2. */
#include "bound_f64.h"

#define ct_set_stream_set_f64 ct_set_stream_avx2
#include "lanes_avx2.h"
#include "set_stream.inc.h"
