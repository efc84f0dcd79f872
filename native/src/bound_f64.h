/* Upper bounds in double: the processor rounds upward (FE_UPWARD), so every operation here returns
 * a value at or above the exact one. The kernel enters and leaves that mode (set.inc.h). */
#ifndef CT_BOUND_F64_H
#define CT_BOUND_F64_H

#include <fenv.h>
#include <math.h>

#define BOUND double
#define SET_FN(name) name##_set_f64
#define SET_ROUNDING FE_UPWARD

static inline double b_from(double x) { return x; }
static inline double b_neg(double a) { return -a; }
static inline double b_add(double a, double b) { return a + b; }
static inline double b_mul(double a, double b) { return a * b; }
static inline double b_div(double a, double b) { return a / b; }
static inline double b_sqrt(double a) { return sqrt(a); }
static inline int b_less(double a, double b) { return a < b; }
static inline double b_to_double(double a) { return a; }

#endif
