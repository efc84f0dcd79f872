/* The precision ladder: which kernels exist on this platform, and their names. */
#include <float.h>

#include "kernel.h"

extern const ct_kernel ct_kernel_f32, ct_kernel_f64, ct_kernel_f64c, ct_kernel_dd;
#if defined(CT_HAVE_FMA_UNITS)
extern const ct_kernel ct_kernel_f64c_fma, ct_kernel_dd_fma;
#endif
#if LDBL_MANT_DIG == 64
extern const ct_kernel ct_kernel_f80;
#endif
#if defined(__SIZEOF_FLOAT128__)
extern const ct_kernel ct_kernel_f128;
#endif

static const ct_kernel *const ladder[] = {
    &ct_kernel_f32,  &ct_kernel_f64,  &ct_kernel_f64c,
#if LDBL_MANT_DIG == 64
    &ct_kernel_f80,
#endif
    &ct_kernel_dd,
#if defined(__SIZEOF_FLOAT128__)
    &ct_kernel_f128,
#endif
};

const ct_kernel *ct_precision_kernel(size_t index, ct_instructions cap) {
  if (index >= sizeof ladder / sizeof *ladder) return NULL;
#if defined(CT_HAVE_FMA_UNITS)
  /* The same bits, faster. */
  if (ct_instructions_usable(cap) >= CT_INSTRUCTIONS_FMA) {
    if (ladder[index] == &ct_kernel_f64c) return &ct_kernel_f64c_fma;
    if (ladder[index] == &ct_kernel_dd) return &ct_kernel_dd_fma;
  }
#else
  (void)cap;
#endif
  return ladder[index];
}

const char *ct_precision_name(size_t index) {
  const ct_kernel *kernel = ct_precision_kernel(index, CT_INSTRUCTIONS_GENERIC);
  return kernel ? kernel->name : NULL;
}
