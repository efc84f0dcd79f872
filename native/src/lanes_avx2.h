/* Lanes of AVX2: 4 doubles, or 8 floats where the includer's REAL has 24 digits. lanes_generic.h
 * says what each operation means; the names and meanings are the same in all.
 */
#ifndef CT_LANES_AVX2_H
#define CT_LANES_AVX2_H

#include <immintrin.h>
#include <stddef.h>
#include <stdint.h>

#if defined(REAL_DIGITS) && REAL_DIGITS == 24
enum { N_LANES = 8 };
typedef float LANE;
typedef int32_t LANE_ID;
typedef __m256 LANES;
#define L_OP(name) _mm256_##name##_ps
#define L_ZERO _mm256_setzero_ps()
#define L_CAST(a) _mm256_castsi256_ps(a)
#define I_CAST(a) _mm256_castps_si256(a)
#define I_ALL _mm256_set1_epi32
#define I_EQUAL _mm256_cmpeq_epi32
#else
enum { N_LANES = 4 };
typedef double LANE;
typedef int64_t LANE_ID;
typedef __m256d LANES;
#define L_OP(name) _mm256_##name##_pd
#define L_ZERO _mm256_setzero_pd()
#define L_CAST(a) _mm256_castsi256_pd(a)
#define I_CAST(a) _mm256_castpd_si256(a)
#define I_ALL _mm256_set1_epi64x
#define I_EQUAL _mm256_cmpeq_epi64
#endif
typedef __m256i IDS;
typedef LANES MASK; /* all bits yes, none no */

/* ---- Masks ---- */

static inline MASK m_none(void) { return L_ZERO; }
static inline unsigned m_bits(MASK m) { return (unsigned)L_OP(movemask)(m); }
static inline int m_any(MASK m) { return L_OP(movemask)(m) != 0; }
static inline MASK m_and(MASK a, MASK b) { return L_OP(and)(a, b); }
static inline MASK m_or(MASK a, MASK b) { return L_OP(or)(a, b); }
static inline MASK m_but(MASK a, MASK b) { return L_OP(andnot)(b, a); }

static inline MASK m_from_bits(unsigned bits) {
#if defined(REAL_DIGITS) && REAL_DIGITS == 24
  __m256i bit = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
#else
  __m256i bit = _mm256_setr_epi64x(1, 2, 4, 8);
#endif
  return L_CAST(I_EQUAL(_mm256_and_si256(I_ALL((int)bits), bit), bit));
}

static inline MASK m_first(size_t n) {
  return m_from_bits(n >= N_LANES ? (1u << N_LANES) - 1 : (1u << n) - 1);
}

/* ---- Numbers ---- */

static inline LANES l_all(LANE x) { return L_OP(set1)(x); }
static inline LANES l_load(const LANE *p) { return L_OP(loadu)(p); }
static inline void l_store(LANE *p, LANES a) { L_OP(storeu)(p, a); }
static inline LANES l_root(LANES a) { return L_OP(sqrt)(a); }
static inline LANES l_abs(LANES a) { return L_OP(andnot)(l_all((LANE)-0.0), a); }
static inline LANES l_lesser(LANES a, LANES b) { return L_OP(min)(a, b); }
static inline LANES l_greater(LANES a, LANES b) { return L_OP(max)(a, b); }

static inline MASK l_less(LANES a, LANES b) { return L_OP(cmp)(a, b, _CMP_LT_OQ); }
static inline MASK l_at_most(LANES a, LANES b) { return L_OP(cmp)(a, b, _CMP_LE_OQ); }
static inline MASK l_not_at_least(LANES a, LANES b) { return L_OP(cmp)(a, b, _CMP_NGE_UQ); }
static inline MASK l_is_number(LANES a) { return L_OP(cmp)(a, a, _CMP_ORD_Q); }
static inline MASK l_nonzero(LANES a) { return L_OP(cmp)(a, L_ZERO, _CMP_NEQ_OQ); }

static inline LANES l_blend(MASK m, LANES a, LANES b) { return L_OP(blendv)(b, a, m); }
static inline LANES l_where(MASK m, LANES a) { return L_OP(and)(m, a); }
static inline LANES l_lesser_where(MASK m, LANES a, LANES b) {
  return l_blend(m, l_lesser(a, b), b);
}
static inline LANES l_greater_where(MASK m, LANES a, LANES b) {
  return l_blend(m, l_greater(a, b), b);
}
static inline LANES l_add_where(MASK m, LANES a, LANES b) { return a + L_OP(and)(m, b); }
static inline LANES l_negate_where(MASK m, LANES a) {
  return L_OP(xor)(a, L_OP(and)(m, l_all((LANE)-0.0)));
}

/* ---- Whole numbers as wide as a lane ---- */

static inline IDS i_all(LANE_ID x) { return I_ALL(x); }
static inline IDS i_blend(MASK m, IDS a, IDS b) {
  return I_CAST(L_OP(blendv)(L_CAST(b), L_CAST(a), m));
}
static inline MASK i_equal(IDS a, IDS b) { return L_CAST(I_EQUAL(a, b)); }
static inline IDS i_load(const LANE_ID *p) {
  return _mm256_loadu_si256((const __m256i *)(const void *)p);
}
static inline void i_store(LANE_ID *p, IDS a) { _mm256_storeu_si256((__m256i *)(void *)p, a); }

static inline MASK l_signs_differ(LANES a, LANES b) {
  LANES x = L_OP(xor)(a, b);
#if defined(REAL_DIGITS) && REAL_DIGITS == 24
  return L_CAST(_mm256_srai_epi32(I_CAST(x), 31));
#else
  return L_CAST(_mm256_cmpgt_epi64(_mm256_setzero_si256(), I_CAST(x)));
#endif
}

/* ---- Packing, which AVX2 has no instruction for: a permutation for every mask ---- */

/* Byte k of PACKED(b) is the place of the k-th bit that is set in b; byte k of UNPACKED(b) is how
 * many bits are set below k. */
#define BIT(b, i) ((uint64_t)(b) >> (i) & 1)
#define BELOW_1(b) BIT(b, 0)
#define BELOW_2(b) (BELOW_1(b) + BIT(b, 1))
#define BELOW_3(b) (BELOW_2(b) + BIT(b, 2))
#define BELOW_4(b) (BELOW_3(b) + BIT(b, 3))
#define BELOW_5(b) (BELOW_4(b) + BIT(b, 4))
#define BELOW_6(b) (BELOW_5(b) + BIT(b, 5))
#define BELOW_7(b) (BELOW_6(b) + BIT(b, 6))
#define PACKED(b)                                                                        \
  (BIT(b, 1) * 1 << 8 * BELOW_1(b) | BIT(b, 2) * 2 << 8 * BELOW_2(b) |                   \
   BIT(b, 3) * 3 << 8 * BELOW_3(b) | BIT(b, 4) * 4 << 8 * BELOW_4(b) |                   \
   BIT(b, 5) * 5 << 8 * BELOW_5(b) | BIT(b, 6) * 6 << 8 * BELOW_6(b) |                   \
   BIT(b, 7) * 7 << 8 * BELOW_7(b))
#define UNPACKED(b)                                                                      \
  (BELOW_1(b) << 8 | BELOW_2(b) << 16 | BELOW_3(b) << 24 | BELOW_4(b) << 32 |            \
   BELOW_5(b) << 40 | BELOW_6(b) << 48 | BELOW_7(b) << 56)
#define FOUR(row, b) row(b), row((b) + 1), row((b) + 2), row((b) + 3)
#define SIXTEEN(row, b) FOUR(row, b), FOUR(row, (b) + 4), FOUR(row, (b) + 8), FOUR(row, (b) + 12)

#if defined(REAL_DIGITS) && REAL_DIGITS == 24
#define SIXTY_FOUR(row, b) \
  SIXTEEN(row, b), SIXTEEN(row, (b) + 16), SIXTEEN(row, (b) + 32), SIXTEEN(row, (b) + 48)
#define ALL_MASKS(row) \
  SIXTY_FOUR(row, 0), SIXTY_FOUR(row, 64), SIXTY_FOUR(row, 128), SIXTY_FOUR(row, 192)

static inline LANES l_permute(LANES a, uint64_t places) {
  return _mm256_permutevar8x32_ps(a, _mm256_cvtepu8_epi32(_mm_cvtsi64_si128((long long)places)));
}
#else
#define ALL_MASKS(row) SIXTEEN(row, 0)

/* A double is two of the instruction's numbers. */
static inline LANES l_permute(LANES a, uint64_t places) {
  __m256i whole = _mm256_cvtepu8_epi64(_mm_cvtsi64_si128((long long)places));
  __m256i low = _mm256_add_epi32(whole, whole);
  __m256i high = _mm256_slli_epi64(_mm256_add_epi32(low, _mm256_set1_epi32(1)), 32);
  __m256i both = _mm256_or_si256(low, high);
  return _mm256_castps_pd(_mm256_permutevar8x32_ps(_mm256_castpd_ps(a), both));
}
#endif

static inline LANES l_pack(MASK m, LANES a) {
  static const uint64_t places[] = {ALL_MASKS(PACKED)};
  return l_permute(a, places[m_bits(m)]);
}

static inline LANES l_unpack(MASK m, LANES a) {
  static const uint64_t places[] = {ALL_MASKS(UNPACKED)};
  return l_permute(a, places[m_bits(m)]);
}

#undef L_OP
#undef L_ZERO
#undef L_CAST
#undef I_CAST
#undef I_ALL
#undef I_EQUAL
#undef BIT
#undef BELOW_1
#undef BELOW_2
#undef BELOW_3
#undef BELOW_4
#undef BELOW_5
#undef BELOW_6
#undef BELOW_7
#undef PACKED
#undef UNPACKED
#undef FOUR
#undef SIXTEEN
#undef SIXTY_FOUR
#undef ALL_MASKS
#endif
