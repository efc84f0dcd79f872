/* Intervals in lanes, [lo, hi] kept as (-lo, hi) as in interval.inc.h: the processor rounds upward,
 * so every sum, product and root here lies at or above the exact one. Products with, and
 * differences of, exact zeros stay exact. Nothing here is given infinities: what could become one
 * is bounded by the callers' guards.
 */

/* One rounding, in any direction, is at most this part of its result. */
#define LANE_U 0x1p-52

typedef struct SET_FN(lanes_interval) {
  LANES n, h; /* -lo and hi */
} VI;

static inline VI vi(LANES n, LANES h) { return (VI){n, h}; }
static inline VI vi_from(IV a) { return vi(l_all(a.nlo), l_all(a.hi)); }
static inline VI vi_add(VI a, VI b) { return vi(a.n + b.n, a.h + b.h); }
static inline VI vi_select(MASK m, VI a, VI b) {
  return vi(l_blend(m, a.n, b.n), l_blend(m, a.h, b.h));
}
/* The other sign in the lanes m. */
static inline VI vi_flip(MASK m, VI a) { return vi(l_blend(m, a.h, a.n), l_blend(m, a.n, a.h)); }
static inline VI vi_floor_zero(VI a) {
  return vi(l_lesser(a.n, l_all(0)), l_greater(a.h, l_all(0)));
}

/* A point of the interval, or near it, and the farthest that the interval reaches from a point. */
static inline LANES vi_middle(VI a) { return (a.h - a.n) * 0.5; }
static inline LANES vi_reach(VI a, LANES point) { return l_greater(a.h - point, a.n + point); }

/* s >= 0, a number without error. */
static inline VI vi_times(LANES s, VI a) { return vi(s * a.n, s * a.h); }

/* p >= 0 throughout. */
static inline VI vi_by_positive(VI p, VI a) {
  LANES lo = -p.n;
  return vi(l_greater(a.n * p.h, a.n * lo), l_greater(a.h * p.h, a.h * lo));
}
/* Both >= 0 throughout. */
static inline VI vi_of_positives(VI a, VI b) { return vi(a.n * -b.n, a.h * b.h); }

static inline VI vi_square(VI a) {
  LANES far = l_greater(a.n, a.h), near = l_greater(-l_lesser(a.n, a.h), l_all(0));
  return vi(near * -near, far * far);
}
static inline VI vi_square3(const VI a[3]) {
  return vi_add(vi_add(vi_square(a[0]), vi_square(a[1])), vi_square(a[2]));
}

/* An interval times the sign of its middle, so that hi >= |lo|: one factor of many products. */
typedef struct SET_FN(lanes_signed) {
  LANES lo, hi;
  MASK minus;
} VS;

static inline VS vs_of(VI a) {
  return (VS){-l_lesser(a.n, a.h), l_greater(a.n, a.h), l_less(a.h, a.n)};
}

static inline VI vs_mul(VS a, VI b, int straddles) {
  b = vi_flip(a.minus, b);
  VI c = vi(l_greater(b.n * a.hi, b.n * a.lo), l_greater(b.h * a.hi, b.h * a.lo));
  /* The product of ends that counts where a.lo < 0 alone; elsewhere it is no more than another. */
  if (straddles) c = vi(l_greater(b.h * -a.lo, c.n), l_greater(b.n * -a.lo, c.h));
  return c;
}

static inline int vs_straddles(VS a) { return m_any(l_less(a.lo, l_all(0))); }
static inline VI vi_mul(VI a, VI b) {
  VS s = vs_of(a);
  return vs_mul(s, b, vs_straddles(s));
}

typedef struct SET_FN(lanes_signed3) {
  VS c[3];
  int straddles; /* in some lane */
} VS3;

static inline VS3 vs3_of(const VI a[3]) {
  VS3 s = {{vs_of(a[0]), vs_of(a[1]), vs_of(a[2])}, 0};
  LANES least = l_lesser(s.c[0].lo, l_lesser(s.c[1].lo, s.c[2].lo));
  s.straddles = m_any(l_less(least, l_all(0)));
  return s;
}

static inline VI vs3_dot(const VS3 *a, const VI b[3]) {
  int s = a->straddles;
  return vi_add(vi_add(vs_mul(a->c[0], b[0], s), vs_mul(a->c[1], b[1], s)),
                vs_mul(a->c[2], b[2], s));
}

/* Root and its inverse of q > 0 with one root and one division.
 *
 * s = sqrt(q.hi) and y = 1/s, each rounded upward once; w = (q.hi - q.lo)/q.hi <= 1/32, of which
 * `width` below is an upper bound but for 3u of itself. For such w, sqrt(1 - w) >= 1 - 0.53w and
 * 1/sqrt(1 - w) <= 1 + 0.6w. So with e = 4u + 0.75 width,
 *   s(1 - e) <= sqrt(q) <= s,  y(1 - 4u) <= 1/sqrt(q) <= y(1 + e),  |y sqrt(q) - 1| <= e.
 */
typedef struct SET_FN(lanes_length) {
  VI length, inverse;
  LANES y, error; /* y and e above */
  MASK known;    /* the lanes where all of this holds */
} LENGTH;

static inline LENGTH length_of(VI q) {
  LENGTH out;
  LANES s = l_root(q.h), y = 1.0 / s;
  LANES width = (q.h + q.n) * (y * y), e = width * 0.75 + 4 * LANE_U;
  out.known = m_and(l_at_most(width, l_all(0x1p-5)), l_less(l_all(0x1p-500), q.h));
  out.length = vi(s * (e - 1.0), s);
  out.inverse = vi(y * (4 * LANE_U - 1.0), y * (e + 1.0));
  out.y = y;
  out.error = e;
  return out;
}

/* x^eta for x >= 0 and an exact integer eta >= 1, by repeated squaring. */
static inline VI vi_power(VI base, double eta) {
  VI result = vi(l_all(-1), l_all(1));
  for (;;) {
    double half = floor(eta / 2);
    if (eta - 2 * half > 0) result = vi_of_positives(result, base);
    if (!(half > 0)) return result;
    base = vi_of_positives(base, base);
    eta = half;
  }
}
