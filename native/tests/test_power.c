/* x^eta of every precision against the widest, within the bounds that power.inc.h claims. */
#include <math.h>

#include "check.h"
#include "probe.h"
#include "random.h"

static double worst;

static void compare(const probe *p, double x, double eta) {
  double got[2], want[2];
  if (p->digits == 24) x = (double)(float)x;
  p->power(x, eta, got);
  WIDEST_PROBE.power(x, eta, want);
  if (want[0] < 0x1p-900) { /* below, digits are lost to underflow */
    CHECK(got[0] >= 0 && got[0] < 0x1p-125);
    return;
  }
  if (p->digits == 24 && want[0] < 0x1p-125) {
    CHECK(got[0] > 0 && got[0] < 0x1p-124); /* there is a highlight, if too dark for float */
    return;
  }
  double error = fabs((got[0] - want[0]) + (got[1] - want[1])) / want[0] / p->unit;
  double log_power = fabs(eta * log(x));
  int squared = eta == floor(eta) && eta <= 1024;
  double allowed = squared ? 1.01 * (eta - 1) + 1 : 4 + 8 * log_power;
  double share = squared ? error / eta : error / (1 + 2 * log_power);
  if (share > worst) worst = share;
  if (error <= allowed) return;
  fprintf(stderr, "%s: %a ^ %a errs by %g units, allowed %g\n", p->name, x, eta, error, allowed);
  exit(1);
}

static void bounds_hold(const probe *p) {
  double result[2];
  worst = 0;
  for (int i = 0; i < 4000; i++) compare(p, uniform_in(0.05, 1), 1 + floor(uniform_in(0, 1024)));
  printf("%-5s integer eta: worst %.2f units a factor", p->name, worst);
  worst = 0;
  for (int i = 0; i < 4000; i++) {
    compare(p, uniform_in(0.01, 1.01), exponential_in(1e-3, 300));
    compare(p, 1 - exponential_in(1e-7, 1e-1), exponential_in(1, 1e6) + 0.5);
    compare(p, exponential_in(1e-30, 1), exponential_in(1e-6, 20));
  }
  printf(", any eta: worst %.2f (1 + 2 |eta ln x|)\n", worst);
  /* The ends of the range. */
  const double etas[] = {1e-100, 1e-3, 0.5, 1, 1023, 1024, 1025, 1e6, 1e17, 1e100};
  for (size_t i = 0; i < sizeof etas / sizeof *etas; i++) {
    p->power(1, etas[i], result);
    CHECK(result[0] == 1 && result[1] == 0);
    p->power(1 + 0x1p-23, etas[i], result);
    CHECK(result[0] >= 1 && isfinite(result[0]) && isfinite(result[1]));
    p->power(0x1p-120, etas[i], result);
    CHECK(result[0] >= 0 && result[0] <= 1 && isfinite(result[1]));
    if (etas[i] >= 1023) CHECK(result[0] == 0);
    if (etas[i] == 1e-100) CHECK(result[0] == 1);
    p->power(1e9, etas[i], result); /* with plane_normal=raw */
    CHECK(result[0] >= 1 && isfinite(result[0]) && isfinite(result[1]));
  }
}

/* The widest type has no wider judge, but two ways to one power: squares, and logarithms. */
static void the_widest_agrees_with_itself(void) {
  for (int i = 0; i < 200; i++) {
    double x = uniform_in(0.1, 1), eta = 1 + floor(uniform_in(0, 200)), a[2], b[2];
    double next = nextafter(eta, 1e9);
    WIDEST_PROBE.power(x, eta, a);
    WIDEST_PROBE.power(x, next, b);
    double ratio = ((b[0] - a[0]) + (b[1] - a[1])) / a[0];
    double want = expm1((next - eta) * log(x));
    CHECK(fabs(ratio - want) <= 0x1p-50 * fabs(want) + 0x1p-98 * eta);
  }
}

int main(void) {
  bounds_hold(&probe_f32);
  bounds_hold(&probe_f64);
#ifdef HAVE_F80
  bounds_hold(&probe_f80);
#endif
#ifdef HAVE_F128
  bounds_hold(&probe_dd);
#endif
  the_widest_agrees_with_itself();
  for (int i = 0; i < 4000; i++) {
    double x = uniform_in(0.01, 1), eta = exponential_in(0.01, 100), got[2];
    probe_f64.power(x, eta, got);
    CHECK(fabs(got[0] - pow(x, eta)) <= (4 + 8 * fabs(eta * log(x))) * 0x1p-53 * got[0]);
  }
  return 0;
}
