/* The scalar type `double` for the kernel text: its operations by name, so that the same text also
 * serves types for which C has no operators. */
#ifndef CT_REAL_F64_H
#define CT_REAL_F64_H

#include <math.h>

#include "wide.h"

#define REAL double
#define FN(name) name##_f64

static inline double from_double(double x) { return x; }
static inline double from_wide(ct_wide x) { return (double)x; }
static inline double to_double(double x) { return x; }
static inline double add(double a, double b) { return a + b; }
static inline double sub(double a, double b) { return a - b; }
static inline double mul(double a, double b) { return a * b; }
static inline double quo(double a, double b) { return a / b; }
static inline double neg(double a) { return -a; }
static inline double root(double a) { return sqrt(a); }
static inline double magnitude(double a) { return fabs(a); }
static inline int less(double a, double b) { return a < b; }
static inline double power_of(double x, double y) { return pow(x, y); }

#endif
