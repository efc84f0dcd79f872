/* The scalar type `float` for the kernel text (see real_f64.h). Scene data are rounded to it. */
#ifndef CT_REAL_F32_H
#define CT_REAL_F32_H

#include <math.h>

#include "wide.h"

#define REAL float
#ifndef FN
#define FN(name) name##_f32
#endif
#define REAL_DIGITS 24
#define REAL_UNIT 0x1p-24
#define REAL_EXP_TERMS 8
#define REAL_LEAST_EXPONENT (-746)
#define REAL_LEAST 0x1p-126
#define REAL_CEILING 0x1p100
#define CONSTANT(high, middle, low) ((float)(high))

static inline float from_double(double x) { return (float)x; }
static inline float from_wide(ct_wide x) { return (float)x; }
static inline double to_double(float x) { return (double)x; }
static inline double to_low(float x) { return (void)x, 0; }
static inline float add(float a, float b) { return a + b; }
static inline float sub(float a, float b) { return a - b; }
static inline float mul(float a, float b) { return a * b; }
static inline float quo(float a, float b) { return a / b; }
static inline float fused(float a, float b, float c) { return fmaf(a, b, c); }
static inline float neg(float a) { return -a; }
static inline float root(float a) { return sqrtf(a); }
static inline float magnitude(float a) { return fabsf(a); }
static inline int less(float a, float b) { return a < b; }
static inline float scale_by(float x, int exponent) { return ldexpf(x, exponent); }
static inline float split_exponent(float x, int *exponent) { return frexpf(x, exponent); }

#endif
