/* What the processor can do, as far as the options allow it to be used. */
#include "instructions.h"

#include <stddef.h>

#include "crosstrace.h"

static ct_instructions best(void) {
#if defined(__x86_64__) && defined(__GNUC__)
  if (!__builtin_cpu_supports("fma")) return CT_INSTRUCTIONS_GENERIC;
  if (!__builtin_cpu_supports("avx2")) return CT_INSTRUCTIONS_FMA;
  /* What vectors of doubles with masks need. */
  if (!__builtin_cpu_supports("avx512f") || !__builtin_cpu_supports("avx512dq") ||
      !__builtin_cpu_supports("avx512vl"))
    return CT_INSTRUCTIONS_AVX2;
  return CT_INSTRUCTIONS_AVX512;
#else
  return CT_INSTRUCTIONS_GENERIC;
#endif
}

ct_instructions ct_instructions_usable(ct_instructions cap) {
  ct_instructions present = best();
  return cap < present ? cap : present;
}

const char *ct_instructions_name(size_t index) {
  static const char *const names[] = {"scalar", "generic", "fma", "avx2", "avx512"};
  return index <= (size_t)best() ? names[index] : NULL;
}
