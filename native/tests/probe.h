/* The powers and primitives of each precision behind one interface of doubles, and the truth in
 * the widest type. Values that a double cannot hold come as the sum of two. */
#ifndef CT_TESTS_PROBE_H
#define CT_TESTS_PROBE_H

#include <float.h>

typedef struct probe {
  const char *name;
  int digits;  /* of the type's significand */
  double unit; /* relative error of one operation */
  void (*power)(double x, double eta, double out[2]);
  /* The nearest root beyond t_min, 0: none. */
  void (*sphere)(const double o[3], const double d[3], const double c[3], double r, double t_min,
                 double out[2]);
  void (*plane)(const double o[3], const double d[3], const double p[3], const double n[3],
                double out[2]);
  /* 0 where light is totally reflected. */
  int (*refraction)(const double wo[3], const double n[3], double cosine, double over,
                    double under, double out[3]);
  double (*highlight)(const double r[3], const double wo[3], double eta);
} probe;

/* Textbook formulas, to be run in a type wide enough to forgive them. */
typedef struct truth {
  /* Both roots for any |d|, rising; 0 where there are none. */
  int (*sphere)(const double o[3], const double d[3], const double c[3], double r,
                double roots[2][2]);
  int (*plane)(const double o[3], const double d[3], const double p[3], const double n[3],
               double out[2]);
  int (*refraction)(const double wo[3], const double n[3], double cosine, double over,
                    double under, double out[3]);
  /* x = r.wo of the directions made of length 1, x^eta and eta ln x. */
  void (*highlight)(const double r[3], const double wo[3], double eta, double out[2],
                    double *exponent);
} truth;

extern const probe probe_f32, probe_f64, probe_f64c, probe_dd;
extern const truth truth_dd;
#if LDBL_MANT_DIG == 64
#define HAVE_F80 1
extern const probe probe_f80;
#endif
#if defined(__SIZEOF_FLOAT128__)
#define HAVE_F128 1
extern const probe probe_f128;
extern const truth truth_f128;
#define WIDEST_PROBE probe_f128
#define TRUTH truth_f128
#else
#define WIDEST_PROBE probe_dd
#define TRUTH truth_dd
#endif

#endif
