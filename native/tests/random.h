/* Random numbers from a fixed seed, for tests: xorshift64* (Vigna 2016). */
#ifndef CT_TESTS_RANDOM_H
#define CT_TESTS_RANDOM_H

#include <math.h>
#include <stdint.h>

static uint64_t random_state = UINT64_C(0x9e3779b97f4a7c15);

/* Uniform in [0, 1). */
static inline double uniform(void) {
  random_state ^= random_state >> 12;
  random_state ^= random_state << 25;
  random_state ^= random_state >> 27;
  return (double)((random_state * UINT64_C(0x2545f4914f6cdd1d)) >> 11) * 0x1p-53;
}

static inline double uniform_in(double a, double b) { return a + (b - a) * uniform(); }

static inline double exponential_in(double a, double b) { return a * pow(b / a, uniform()); }

static inline void random_direction(double d[3]) {
  double length2;
  do {
    length2 = 0;
    for (int k = 0; k < 3; k++) {
      d[k] = uniform_in(-1, 1);
      length2 += d[k] * d[k];
    }
  } while (length2 > 1 || length2 < 0.01);
  for (int k = 0; k < 3; k++) d[k] /= sqrt(length2);
}

/* A direction at a right angle to d. */
static inline void random_normal_to(const double d[3], double out[3]) {
  double e[3], dot, length2;
  do {
    random_direction(e);
    dot = e[0] * d[0] + e[1] * d[1] + e[2] * d[2];
    length2 = 0;
    for (int k = 0; k < 3; k++) {
      out[k] = e[k] - dot * d[k];
      length2 += out[k] * out[k];
    }
  } while (length2 < 0.01);
  for (int k = 0; k < 3; k++) out[k] /= sqrt(length2);
}

#endif
