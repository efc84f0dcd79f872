/* The scalar type `double` for the kernel text: its operations by name, so that the same text also
 * serves types for which C has no operators. Beside the arithmetic a type says
 *   REAL_UNIT             half a unit in the last place of 1, relative error of an operation
 *   REAL_DIGITS           bits of its significand
 *   REAL_EXP_TERMS        terms of the exponential series (power.inc.h)
 *   REAL_LEAST_EXPONENT   y below which exp(y) counts as 0, the same in all: double's
 *   REAL_LEAST            what powers between double's least and the type's count as
 *   REAL_CEILING          greatest value of a power
 *   CONSTANT(h, m, l)     the sum of three doubles as a constant
 *   to_low                what to_double leaves, as a double
 *   fused                 a*b + c rounded once (types that have compensated primitives)
 */
#ifndef CT_REAL_F64_H
#define CT_REAL_F64_H

#include <math.h>

#include "wide.h"

#define REAL double
#ifndef FN
#define FN(name) name##_f64
#endif
#define REAL_DIGITS 53
#define REAL_UNIT 0x1p-53
#define REAL_EXP_TERMS 14
#define REAL_LEAST_EXPONENT (-746)
#define REAL_LEAST 0
#define REAL_CEILING 0x1p1000
#define CONSTANT(high, middle, low) (high)

static inline double from_double(double x) { return x; }
static inline double from_wide(ct_wide x) { return (double)x; }
static inline double to_double(double x) { return x; }
static inline double to_low(double x) { return (void)x, 0; }
static inline double add(double a, double b) { return a + b; }
static inline double sub(double a, double b) { return a - b; }
static inline double mul(double a, double b) { return a * b; }
static inline double quo(double a, double b) { return a / b; }
static inline double fused(double a, double b, double c) { return fma(a, b, c); }
static inline double neg(double a) { return -a; }
static inline double root(double a) { return sqrt(a); }
static inline double magnitude(double a) { return fabs(a); }
static inline int less(double a, double b) { return a < b; }
static inline double scale_by(double x, int exponent) { return ldexp(x, exponent); }
static inline double split_exponent(double x, int *exponent) { return frexp(x, exponent); }

#endif
