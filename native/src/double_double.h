/* A double-double and the error-free transformations that all of its arithmetic rests on. Internal.
 *
 * Exact while the processor rounds to nearest: Dekker's and Knuth's sums, and the product by fma.
 */
#ifndef CT_DOUBLE_DOUBLE_H
#define CT_DOUBLE_DOUBLE_H

#include <math.h>

typedef struct ct_dd {
  double h, l;
} ct_dd;

/* |a| >= |b|, or a = 0. */
static inline ct_dd fast_two_sum(double a, double b) {
  double s = a + b;
  return (ct_dd){s, b - (s - a)};
}

static inline ct_dd two_sum(double a, double b) {
  double s = a + b, t = s - a;
  return (ct_dd){s, (a - (s - t)) + (b - t)};
}

static inline ct_dd two_product(double a, double b) {
  double p = a * b;
  return (ct_dd){p, fma(a, b, -p)};
}

#endif
