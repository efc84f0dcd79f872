/* The certified streams: any processor, by the compiler's vectors. */
#include "bound_f64.h"

#define ct_set_stream_set_f64 ct_set_stream_generic
#include "lanes_generic.h"
#include "set_stream.inc.h"
