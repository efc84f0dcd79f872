/* Errors of one form of a primitive over one family of inputs: quantiles, wrong decisions, and the
 * input that did worst. */
#ifndef CT_TESTS_TALLY_H
#define CT_TESTS_TALLY_H

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "check.h"

enum { MAX_INPUT = 12, MAX_ERRORS = 4096 };

/* What became of one input. */
typedef enum outcome { AGREES, FALSE_HIT, MISS, WRONG_ROOT } outcome;

typedef struct tally {
  size_t n, n_errors;
  int n_wrong[4]; /* by outcome */
  int n_beyond;   /* inputs whose error is beyond what is claimed */
  double errors[MAX_ERRORS], worst, worst_input[MAX_INPUT];
} tally;

static inline void tally_clear(tally *t) { memset(t, 0, sizeof *t); }

static inline void tally_add(tally *t, outcome what, double error, const double *input) {
  t->n++;
  t->n_wrong[what]++;
  if (what != AGREES) return;
  if (t->n_errors < MAX_ERRORS) t->errors[t->n_errors++] = error;
  if (!(error <= t->worst)) {
    t->worst = error;
    memcpy(t->worst_input, input, sizeof t->worst_input);
  }
}

static int compare_doubles(const void *a, const void *b) {
  double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

/* Sorts the errors. */
static inline double tally_quantile(tally *t, double share) {
  if (t->n_errors == 0) return 0;
  qsort(t->errors, t->n_errors, sizeof *t->errors, compare_doubles);
  return t->errors[(size_t)(share * (double)(t->n_errors - 1))];
}

static inline int tally_n_wrong(const tally *t) {
  return t->n_wrong[FALSE_HIT] + t->n_wrong[MISS] + t->n_wrong[WRONG_ROOT];
}

/* p99, worst, and false hits/misses/wrong roots in 10^4. */
static inline void tally_print(tally *t) {
  double per = t->n ? 1e4 / (double)t->n : 0;
  printf("  %8.2g %8.2g %5.0f/%4.0f/%4.0f", tally_quantile(t, 0.99), t->worst,
         t->n_wrong[FALSE_HIT] * per, t->n_wrong[MISS] * per, t->n_wrong[WRONG_ROOT] * per);
}

#endif
