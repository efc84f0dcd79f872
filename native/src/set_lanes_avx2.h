/* Four lanes of double in AVX2, for the certified streams (see set_lanes_avx512.h). */
#ifndef CT_SET_LANES_H
#define CT_SET_LANES_H

#include <immintrin.h>

enum { N_LANES = 4 };

typedef __m256d V;
typedef __m256d M;

static inline V v_from(double x) { return _mm256_set1_pd(x); }
static inline V v_load(const double *p) { return _mm256_loadu_pd(p); }
static inline void v_store(double *p, V a) { _mm256_storeu_pd(p, a); }
static inline V v_max(V a, V b) { return _mm256_max_pd(a, b); }
static inline V v_min(V a, V b) { return _mm256_min_pd(a, b); }
static inline V v_magnitude(V a) { return _mm256_andnot_pd(v_from(-0.0), a); }
static inline V v_sqrt(V a) { return _mm256_sqrt_pd(a); }

static inline M v_less(V a, V b) { return _mm256_cmp_pd(a, b, _CMP_LT_OQ); }
static inline M v_at_most(V a, V b) { return _mm256_cmp_pd(a, b, _CMP_LE_OQ); }
static inline M v_equal(V a, V b) { return _mm256_cmp_pd(a, b, _CMP_EQ_OQ); }
static inline V v_select(M m, V a, V b) { return _mm256_blendv_pd(b, a, m); }

static inline M m_and(M a, M b) { return _mm256_and_pd(a, b); }
static inline M m_or(M a, M b) { return _mm256_or_pd(a, b); }
static inline M m_without(M a, M b) { return _mm256_andnot_pd(b, a); }
static inline unsigned m_bits(M a) { return (unsigned)_mm256_movemask_pd(a); }
static inline M m_from_bits(unsigned bits) {
  const __m256i of_lane = _mm256_set_epi64x(8, 4, 2, 1);
  __m256i chosen = _mm256_and_si256(_mm256_set1_epi64x((long long)bits), of_lane);
  return _mm256_castsi256_pd(_mm256_cmpeq_epi64(chosen, of_lane));
}

static inline V v_pack(M m, V a) {
  double in[4], out[4] = {0, 0, 0, 0};
  int n = 0;
  v_store(in, a);
  for (unsigned bits = m_bits(m); bits; bits &= bits - 1) out[n++] = in[__builtin_ctz(bits)];
  return v_load(out);
}

static inline V v_unpack(M m, V a) {
  double in[4], out[4] = {0, 0, 0, 0};
  int n = 0;
  v_store(in, a);
  for (unsigned bits = m_bits(m); bits; bits &= bits - 1) out[__builtin_ctz(bits)] = in[n++];
  return v_load(out);
}

#endif
