/* Two lanes of double in the compiler's own vectors, for the certified streams on any processor
 * (see set_lanes_avx512.h). */
#ifndef CT_SET_LANES_H
#define CT_SET_LANES_H

#include <math.h>
#include <stdint.h>
#include <string.h>

enum { N_LANES = 2 };

typedef double V __attribute__((vector_size(16)));
typedef long long M __attribute__((vector_size(16)));

static inline V v_from(double x) { return (V){x, x}; }
static inline V v_load(const double *p) {
  V a;
  memcpy(&a, p, sizeof a);
  return a;
}
static inline void v_store(double *p, V a) { memcpy(p, &a, sizeof a); }
static inline V v_select(M m, V a, V b) { return (V)(((M)a & m) | ((M)b & ~m)); }
static inline V v_max(V a, V b) { return v_select((M)(a > b), a, b); }
static inline V v_min(V a, V b) { return v_select((M)(a < b), a, b); }
static inline V v_magnitude(V a) { return (V)((M)a & INT64_MAX); }
static inline V v_sqrt(V a) { return (V){sqrt(a[0]), sqrt(a[1])}; }

static inline M v_less(V a, V b) { return (M)(a < b); }
static inline M v_at_most(V a, V b) { return (M)(a <= b); }
static inline M v_equal(V a, V b) { return (M)(a == b); }

static inline M m_and(M a, M b) { return a & b; }
static inline M m_or(M a, M b) { return a | b; }
static inline M m_without(M a, M b) { return a & ~b; }
static inline unsigned m_bits(M a) { return (unsigned)((a[0] & 1) | (a[1] & 2)); }
static inline M m_from_bits(unsigned bits) {
  return (M){-(long long)(bits & 1), -(long long)(bits >> 1 & 1)};
}

static inline V v_pack(M m, V a) {
  return (V){m[0] ? a[0] : m[1] ? a[1] : 0, m[0] && m[1] ? a[1] : 0};
}
static inline V v_unpack(M m, V a) { return (V){m[0] ? a[0] : 0, m[1] ? a[m[0] ? 1 : 0] : 0}; }

#endif
