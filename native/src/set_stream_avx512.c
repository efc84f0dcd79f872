/* The certified streams: AVX-512. */
#include "bound_f64.h"

#define ct_set_stream_set_f64 ct_set_stream_avx512
#include "lanes_avx512.h"
#include "set_stream.inc.h"
