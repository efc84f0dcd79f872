/* The x87's long double, 64 bits of significand, for the kernel text (see real_f64.h). */
#ifndef CT_REAL_F80_H
#define CT_REAL_F80_H

#include <math.h>

#include "wide.h"

#define REAL long double
#ifndef FN
#define FN(name) name##_f80
#endif
#define REAL_DIGITS 64
#define REAL_UNIT 0x1p-64
#define REAL_EXP_TERMS 16
#define REAL_LEAST_EXPONENT (-746) /* what double takes for 0 is 0, or ray trees would differ */
#define REAL_LEAST 0
#define REAL_CEILING 0x1p1000
#define CONSTANT(high, middle, low) ((long double)(high) + (long double)(middle))

static inline long double from_double(double x) { return x; }
static inline long double from_wide(ct_wide x) { return (long double)x; }
static inline double to_double(long double x) { return (double)x; }
static inline double to_low(long double x) { return (double)(x - (double)x); }
static inline long double add(long double a, long double b) { return a + b; }
static inline long double sub(long double a, long double b) { return a - b; }
static inline long double mul(long double a, long double b) { return a * b; }
static inline long double quo(long double a, long double b) { return a / b; }
static inline long double neg(long double a) { return -a; }
static inline long double root(long double a) { return sqrtl(a); }
static inline long double magnitude(long double a) { return fabsl(a); }
static inline int less(long double a, long double b) { return a < b; }
static inline long double scale_by(long double x, int exponent) { return ldexpl(x, exponent); }
static inline long double split_exponent(long double x, int *exponent) {
  return frexpl(x, exponent);
}

#endif
