/* Bounds in double-double lie above the exact result and close to it; zeros stay exact. */
#include <math.h>
#include <stdint.h>

#include "check.h"
#include "wide.h"

#include "bound_dd.h"

#if defined(__SIZEOF_FLOAT128__)
static uint64_t state = 7;

static double random_double(void) {
  state = state * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
  double unit = (double)(state >> 11) * 0x1p-53;
  state = state * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
  return ldexp(2 * unit - 1, (int)(state >> 58) - 32);
}

static BOUND random_bound(void) {
  double h = random_double();
  /* A low word of few bits, so that float128 holds the sum exactly. */
  return fast_two_sum(h, ldexp((double)(int)(state >> 40) - 0x1p23, ilogb(h) - 80));
}

static ct_wide wide(BOUND a) { return (ct_wide)a.h + (ct_wide)a.l; }

/* float128 rounds at 2^-113, far below the 2^-100 that is checked here. */
static void is_just_above(BOUND bound, ct_wide exact) {
  ct_wide slack = wide(bound) - exact, size = exact < 0 ? -exact : exact;
  CHECK(slack >= 0);
  CHECK(slack <= size * (ct_wide)0x1p-98 + (ct_wide)0x1p-900);
}

int main(void) {
  for (int i = 0; i < 200000; i++) {
    BOUND a = random_bound(), b = random_bound();
    /* Sums that cancel, too. */
    if (i % 3 == 0) b = (BOUND){-a.h * (1 + (i % 7) * 0x1p-52), a.l / 2};
    is_just_above(b_add(a, b), wide(a) + wide(b));
    is_just_above(b_mul(a, b), wide(a) * wide(b));
    if (b.h != 0) is_just_above(b_div(a, b), wide(a) / wide(b));
    BOUND square = b_mul(a, a), root = b_sqrt(square);
    CHECK(wide(root) * wide(root) >= wide(square) * (1 - (ct_wide)0x1p-110));
    CHECK(b_less(root, b_add((BOUND){fabs(a.h) * (1 + 0x1p-50), 0}, b_from(0x1p-800))));
  }
  BOUND x = random_bound(), zero = b_add(x, b_neg(x));
  CHECK(zero.h == 0 && zero.l == 0);
  CHECK(b_mul(x, b_from(0)).h == 0 && b_div(b_from(0), x).h == 0 && b_sqrt(b_from(0)).h == 0);
  return 0;
}
#else
int main(void) { return 0; }
#endif
