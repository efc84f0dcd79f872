/* Which stream serves: by precision, by what the processor has and the options allow, and by the
 * readings. */
#include "stream.h"

#include <string.h>

#if defined(CT_HAVE_LANES)
extern const ct_stream ct_stream_f32_generic, ct_stream_f64_generic;
#endif
#if defined(CT_HAVE_LANES_AVX2)
extern const ct_stream ct_stream_f32_avx2, ct_stream_f64_avx2;
#endif
#if defined(CT_HAVE_LANES_AVX512)
extern const ct_stream ct_stream_f32_avx512, ct_stream_f64_avx512;
#endif

/* Readings whose every value the stream's text knows; of the others it knows the default. */
static int is_known(int choice) {
  return choice == CT_EPSILON_TWICE || choice == CT_DEPTH || choice == CT_EXHAUSTED ||
         choice == CT_MISS || choice == CT_SIDE || choice == CT_INDEX;
}

static int serves(const ct_options *options) {
  if (options->rounding != CT_ROUND_NEAREST) return 0;
  for (int i = 0; i < CT_N_CHOICES; i++)
    if (options->choice[i] != 0 && !is_known(i)) return 0;
  return 1;
}

const ct_stream *ct_stream_for(const ct_options *options) {
  ct_instructions usable = ct_instructions_usable(options->instructions);
  const char *precision = ct_precision_name(options->precision);
  int is_double = strcmp(precision, "f64") == 0;
  if (!is_double && strcmp(precision, "f32") != 0) return NULL;
  if (!serves(options)) return NULL;
#if defined(CT_HAVE_LANES_AVX512)
  if (usable >= CT_INSTRUCTIONS_AVX512)
    return is_double ? &ct_stream_f64_avx512 : &ct_stream_f32_avx512;
#endif
#if defined(CT_HAVE_LANES_AVX2)
  if (usable >= CT_INSTRUCTIONS_AVX2) return is_double ? &ct_stream_f64_avx2 : &ct_stream_f32_avx2;
#endif
#if defined(CT_HAVE_LANES)
  if (usable >= CT_INSTRUCTIONS_GENERIC)
    return is_double ? &ct_stream_f64_generic : &ct_stream_f32_generic;
#endif
  return NULL;
}
