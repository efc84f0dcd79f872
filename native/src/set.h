/* Set-valued tracing: an enclosure of a pixel's value in real arithmetic, for one type of bounds.
 * The text (set.inc.h) is independent of the point kernel on purpose: the two check each other. */
#ifndef CT_SET_H
#define CT_SET_H

#include <stdatomic.h>

#include "crosstrace.h"
#include "frame.h"

/* Mitsuba's constants (its math.h): 1500 and 15000 times 2^-24, and its near plane. */
#define SET_MITSUBA_RAY 0x1.77p-14
#define SET_MITSUBA_SHADOW 0x1.d4cp-11
#define SET_MITSUBA_NEAR 1e-2
/* An undecided light that can add no more than this is enclosed with and without. */
#define SET_NEGLIGIBLE 1e-13

enum { CT_MAX_DECISIONS = 64, CT_MAX_CANDIDATES = 16 };

typedef enum ct_set_status {
  CT_SET_DECIDED,   /* every decision was certain: one enclosure */
  CT_SET_AMBIGUOUS, /* some decision was not; all its outcomes were followed */
  CT_SET_PRECISION, /* a quantity was too wide to go on with */
  CT_SET_BUDGET     /* more outcomes, decisions or rays than allowed */
} ct_set_status;

/* What could not be decided first, and where: the depth of the ray and the object concerned. */
typedef struct ct_decision {
  int kind; /* ct_certify_decision */
  int64_t depth, object;
} ct_decision;

typedef struct ct_set_result {
  ct_set_status status;
  double lo[3], hi[3]; /* of all outcomes together */
  size_t n_alternatives; /* distinct outcomes; those beyond the array are in lo and hi alone */
  double alternatives[CT_ALTERNATIVES][2][3];
  ct_decision first;
  uint64_t n_rays;
} ct_set_result;

typedef struct ct_set_limits {
  int n_outcomes;  /* how many combinations of decisions to follow */
  uint64_t n_rays; /* of one pixel */
  const atomic_int *stop;
} ct_set_limits;

typedef struct ct_set_kernel {
  const char *name;
  int rounding; /* of fesetround, in which every function here is to be called */
  /* kappa: relative error of the arithmetic under test, 0 for truth; enclosures then hold what a
   * renderer of that arithmetic may return. */
  ct_status (*open)(const ct_frame *frame, double kappa, void **world);
  void (*close)(void *world);
  void (*pixel)(const void *world, int64_t row, int64_t column, const ct_set_limits *limits,
                ct_set_result *result);
} ct_set_kernel;

extern const ct_set_kernel ct_set_kernel_f64, ct_set_kernel_dd;
#if defined(CT_HAVE_FMA_UNITS)
extern const ct_set_kernel ct_set_kernel_dd_fma;
#endif
#if defined(__SIZEOF_FLOAT128__)
extern const ct_set_kernel ct_set_kernel_f128;
#endif

#endif
