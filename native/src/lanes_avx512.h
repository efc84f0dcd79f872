/* Lanes of AVX-512 (F, DQ, VL): 8 doubles, or 16 floats where the includer's REAL has 24 digits.
 * lanes_generic.h says what each operation means; the names and meanings are the same in all.
 */
#ifndef CT_LANES_AVX512_H
#define CT_LANES_AVX512_H

#include <immintrin.h>
#include <stddef.h>
#include <stdint.h>

#if defined(REAL_DIGITS) && REAL_DIGITS == 24
enum { N_LANES = 16 };
typedef float LANE;
typedef int32_t LANE_ID;
typedef __m512 LANES;
typedef __mmask16 MASK;
#define L_OP(name) _mm512_##name##_ps
#define L_SIGNS(a) _mm512_movepi32_mask(_mm512_castps_si512(a))
#define I_OP(name) _mm512_##name##_epi32
#define L_COMPARE _mm512_cmp_ps_mask
#define I_COMPARE _mm512_cmpeq_epi32_mask
#else
enum { N_LANES = 8 };
typedef double LANE;
typedef int64_t LANE_ID;
typedef __m512d LANES;
typedef __mmask8 MASK;
#define L_OP(name) _mm512_##name##_pd
#define L_SIGNS(a) _mm512_movepi64_mask(_mm512_castpd_si512(a))
#define I_OP(name) _mm512_##name##_epi64
#define L_COMPARE _mm512_cmp_pd_mask
#define I_COMPARE _mm512_cmpeq_epi64_mask
#endif
typedef __m512i IDS;

/* ---- Masks ---- */

static inline MASK m_none(void) { return 0; }
static inline MASK m_from_bits(unsigned bits) { return (MASK)bits; }
static inline unsigned m_bits(MASK m) { return m; }
static inline int m_any(MASK m) { return m != 0; }
static inline MASK m_first(size_t n) {
  return (MASK)(n >= N_LANES ? (1u << N_LANES) - 1 : (1u << n) - 1);
}
static inline MASK m_and(MASK a, MASK b) { return (MASK)(a & b); }
static inline MASK m_or(MASK a, MASK b) { return (MASK)(a | b); }
static inline MASK m_but(MASK a, MASK b) { return (MASK)(a & ~b); }

/* ---- Numbers ---- */

static inline LANES l_all(LANE x) { return L_OP(set1)(x); }
static inline LANES l_load(const LANE *p) { return L_OP(loadu)(p); }
static inline void l_store(LANE *p, LANES a) { L_OP(storeu)(p, a); }
static inline LANES l_root(LANES a) { return L_OP(sqrt)(a); }
static inline LANES l_abs(LANES a) { return L_OP(abs)(a); }
static inline LANES l_lesser(LANES a, LANES b) { return L_OP(min)(a, b); }
static inline LANES l_greater(LANES a, LANES b) { return L_OP(max)(a, b); }

static inline MASK l_less(LANES a, LANES b) { return L_COMPARE(a, b, _CMP_LT_OQ); }
static inline MASK l_at_most(LANES a, LANES b) { return L_COMPARE(a, b, _CMP_LE_OQ); }
static inline MASK l_not_at_least(LANES a, LANES b) { return L_COMPARE(a, b, _CMP_NGE_UQ); }
static inline MASK l_is_number(LANES a) { return L_COMPARE(a, a, _CMP_ORD_Q); }
static inline MASK l_nonzero(LANES a) { return L_COMPARE(a, L_OP(setzero)(), _CMP_NEQ_OQ); }
static inline MASK l_signs_differ(LANES a, LANES b) { return L_SIGNS(L_OP(xor)(a, b)); }

static inline LANES l_blend(MASK m, LANES a, LANES b) { return L_OP(mask_blend)(m, b, a); }
static inline LANES l_where(MASK m, LANES a) { return L_OP(maskz_mov)(m, a); }
static inline LANES l_add_where(MASK m, LANES a, LANES b) { return L_OP(mask_add)(a, m, a, b); }
static inline LANES l_lesser_where(MASK m, LANES a, LANES b) { return L_OP(mask_min)(b, m, a, b); }
static inline LANES l_greater_where(MASK m, LANES a, LANES b) {
  return L_OP(mask_max)(b, m, a, b);
}
static inline LANES l_negate_where(MASK m, LANES a) {
  return L_OP(mask_xor)(a, m, a, L_OP(set1)((LANE)-0.0));
}

static inline LANES l_pack(MASK m, LANES a) { return L_OP(maskz_compress)(m, a); }
static inline LANES l_unpack(MASK m, LANES a) { return L_OP(maskz_expand)(m, a); }

/* ---- Whole numbers as wide as a lane ---- */

static inline IDS i_all(LANE_ID x) { return I_OP(set1)(x); }
static inline IDS i_blend(MASK m, IDS a, IDS b) { return I_OP(mask_blend)(m, b, a); }
static inline MASK i_equal(IDS a, IDS b) { return I_COMPARE(a, b); }
static inline IDS i_load(const LANE_ID *p) { return _mm512_loadu_si512(p); }
static inline void i_store(LANE_ID *p, IDS a) { _mm512_storeu_si512(p, a); }

#undef L_OP
#undef L_SIGNS
#undef I_OP
#undef L_COMPARE
#undef I_COMPARE
#endif
