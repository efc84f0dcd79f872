/* Eight lanes of double in AVX-512, for the certified streams. A maximum or minimum returns its
 * second operand where the two are equal or one is no number, in every shim alike. */
#ifndef CT_SET_LANES_H
#define CT_SET_LANES_H

#include <immintrin.h>

enum { N_LANES = 8 };

typedef __m512d V;
typedef __mmask8 M;

static inline V v_from(double x) { return _mm512_set1_pd(x); }
static inline V v_load(const double *p) { return _mm512_loadu_pd(p); }
static inline void v_store(double *p, V a) { _mm512_storeu_pd(p, a); }
static inline V v_max(V a, V b) { return _mm512_max_pd(a, b); }
static inline V v_min(V a, V b) { return _mm512_min_pd(a, b); }
static inline V v_magnitude(V a) { return _mm512_abs_pd(a); }
static inline V v_sqrt(V a) { return _mm512_sqrt_pd(a); }

/* False where one is no number. */
static inline M v_less(V a, V b) { return _mm512_cmp_pd_mask(a, b, _CMP_LT_OQ); }
static inline M v_at_most(V a, V b) { return _mm512_cmp_pd_mask(a, b, _CMP_LE_OQ); }
static inline M v_equal(V a, V b) { return _mm512_cmp_pd_mask(a, b, _CMP_EQ_OQ); }
static inline V v_select(M m, V a, V b) { return _mm512_mask_blend_pd(m, b, a); }

static inline M m_and(M a, M b) { return (M)(a & b); }
static inline M m_or(M a, M b) { return (M)(a | b); }
static inline M m_without(M a, M b) { return (M)(a & ~b); }
static inline unsigned m_bits(M a) { return a; }
static inline M m_from_bits(unsigned bits) { return (M)bits; }

/* The chosen lanes moved together at the front, and back. */
static inline V v_pack(M m, V a) { return _mm512_maskz_compress_pd(m, a); }
static inline V v_unpack(M m, V a) { return _mm512_maskz_expand_pd(m, a); }

#endif
