/* Numbers side by side in the vector types of GCC and clang, 16 bytes of them, which the compiler
 * turns into what the processor has. The other lanes_*.h have the same names for more lanes.
 *
 * LANES are numbers of the type LANE (float where the includer's REAL has 24 digits, else double),
 * and take the operators + - * / and the unary -, each rounded as the scalar one. A MASK says yes
 * or no for every lane; comparisons say no where an operand is not a number. IDS are whole numbers
 * of the same width.
 */
#ifndef CT_LANES_GENERIC_H
#define CT_LANES_GENERIC_H

#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#if defined(REAL_DIGITS) && REAL_DIGITS == 24
typedef float LANE;
typedef int32_t LANE_ID;
#else
typedef double LANE;
typedef int64_t LANE_ID;
#endif
enum { N_LANES = 16 / sizeof(LANE) };
typedef LANE LANES __attribute__((vector_size(16)));
typedef LANE_ID IDS __attribute__((vector_size(16)));
typedef IDS MASK; /* -1 yes, 0 no */

/* ---- Masks: bit k of m_bits is lane k ---- */

static inline MASK m_none(void) { return (MASK){0}; }

static inline MASK m_from_bits(unsigned bits) {
  MASK m;
  for (int k = 0; k < N_LANES; k++) m[k] = -(LANE_ID)(bits >> k & 1);
  return m;
}

static inline unsigned m_bits(MASK m) {
  unsigned bits = 0;
  for (int k = 0; k < N_LANES; k++) bits |= ((unsigned)m[k] & 1) << k;
  return bits;
}

static inline int m_any(MASK m) {
  LANE_ID any = 0;
  for (int k = 0; k < N_LANES; k++) any |= m[k];
  return any != 0;
}

/* Yes for the first n lanes. */
static inline MASK m_first(size_t n) {
  MASK m;
  for (int k = 0; k < N_LANES; k++) m[k] = -(LANE_ID)((size_t)k < n);
  return m;
}

static inline MASK m_and(MASK a, MASK b) { return a & b; }
static inline MASK m_or(MASK a, MASK b) { return a | b; }
static inline MASK m_but(MASK a, MASK b) { return a & ~b; } /* a and not b */

/* ---- Numbers ---- */

static inline LANES l_all(LANE x) {
  LANES a;
  for (int k = 0; k < N_LANES; k++) a[k] = x;
  return a;
}

/* Of any alignment. */
static inline LANES l_load(const LANE *p) {
  LANES a;
  memcpy(&a, p, sizeof a);
  return a;
}

static inline void l_store(LANE *p, LANES a) { memcpy(p, &a, sizeof a); }

static inline LANES l_root(LANES a) {
  for (int k = 0; k < N_LANES; k++)
    a[k] = sizeof(LANE) == sizeof(float) ? (LANE)sqrtf((float)a[k]) : (LANE)sqrt((double)a[k]);
  return a;
}

static inline IDS l_sign_bit(void) { return (IDS)l_all((LANE)-0.0); }

static inline LANES l_abs(LANES a) { return (LANES)((IDS)a & ~l_sign_bit()); }

/* m ? a : b */
static inline LANES l_blend(MASK m, LANES a, LANES b) {
  return (LANES)((m & (IDS)a) | (~m & (IDS)b));
}

/* m ? a : 0 */
static inline LANES l_where(MASK m, LANES a) { return (LANES)(m & (IDS)a); }

static inline MASK l_less(LANES a, LANES b) { return (MASK)(a < b); }
static inline MASK l_at_most(LANES a, LANES b) { return (MASK)(a <= b); }
/* !(a >= b): yes also where either is not a number. */
static inline MASK l_not_at_least(LANES a, LANES b) { return ~(MASK)(a >= b); }
static inline MASK l_is_number(LANES a) { return (MASK)(a == a); }
/* No where a is not a number. */
static inline MASK l_nonzero(LANES a) { return (MASK)(l_abs(a) > (LANES){0}); }
static inline MASK l_signs_differ(LANES a, LANES b) {
  return (MASK)(((IDS)a ^ (IDS)b) < (IDS){0});
}

/* a < b ? a : b, and b < a ? a : b */
static inline LANES l_lesser(LANES a, LANES b) { return l_blend(l_less(a, b), a, b); }
static inline LANES l_greater(LANES a, LANES b) { return l_blend(l_less(b, a), a, b); }

/* m ? the lesser (greater) of both : b */
static inline LANES l_lesser_where(MASK m, LANES a, LANES b) {
  return l_blend(m, l_lesser(a, b), b);
}
static inline LANES l_greater_where(MASK m, LANES a, LANES b) {
  return l_blend(m, l_greater(a, b), b);
}

/* m ? a + b : a, for an a that is not -0 */
static inline LANES l_add_where(MASK m, LANES a, LANES b) { return a + l_where(m, b); }
/* m ? -a : a */
static inline LANES l_negate_where(MASK m, LANES a) { return (LANES)((IDS)a ^ (m & l_sign_bit())); }

/* The lanes of the mask moved to the front in their order; what follows has no meaning. */
static inline LANES l_pack(MASK m, LANES a) {
  LANES out = a;
  for (int k = 0, at = 0; k < N_LANES; k++)
    if (m[k]) out[at++] = a[k];
  return out;
}

/* And back: the first lanes moved to those of the mask; what the others hold has no meaning. */
static inline LANES l_unpack(MASK m, LANES a) {
  LANES out = a;
  for (int k = 0, at = 0; k < N_LANES; k++)
    if (m[k]) out[k] = a[at++];
  return out;
}

/* ---- Whole numbers as wide as a lane ---- */

static inline IDS i_all(LANE_ID x) {
  IDS a;
  for (int k = 0; k < N_LANES; k++) a[k] = x;
  return a;
}
static inline IDS i_blend(MASK m, IDS a, IDS b) { return (m & a) | (~m & b); }
static inline MASK i_equal(IDS a, IDS b) { return (MASK)(a == b); }
static inline IDS i_load(const LANE_ID *p) {
  IDS a;
  memcpy(&a, p, sizeof a);
  return a;
}
static inline void i_store(LANE_ID *p, IDS a) { memcpy(p, &a, sizeof a); }

#endif
