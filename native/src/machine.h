/* The floating-point state of the calling thread, saved and set to the IEEE default. Internal.
 *
 * Other libraries in a process may have asked for flush-to-zero or another rounding mode, and both
 * would change our bits.
 */
#ifndef CT_MACHINE_H
#define CT_MACHINE_H

#include <fenv.h>

#if defined(__SSE__) || defined(__x86_64__)
#include <xmmintrin.h>
#define CT_HAVE_MXCSR 1
#endif

typedef struct ct_machine_state {
  fenv_t environment;
#ifdef CT_HAVE_MXCSR
  unsigned mxcsr;
#endif
} ct_machine_state;

static inline ct_machine_state ct_machine_enter(void) {
  ct_machine_state state;
  fegetenv(&state.environment);
#ifdef CT_HAVE_MXCSR
  state.mxcsr = _mm_getcsr();
#endif
  fesetenv(FE_DFL_ENV);
#ifdef CT_HAVE_MXCSR
  _mm_setcsr(0x1f80); /* all exceptions masked, to nearest, denormals kept */
#endif
  return state;
}

static inline void ct_machine_leave(ct_machine_state state) {
  fesetenv(&state.environment);
#ifdef CT_HAVE_MXCSR
  _mm_setcsr(state.mxcsr);
#endif
}

#endif
