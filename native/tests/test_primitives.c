/* Plain and compensated primitives over families of hard inputs, against the widest type.
 *
 *   test_primitives FOLDER            prints the tables and replays FOLDER's worst inputs
 *   test_primitives FOLDER collect    writes the worst inputs of this run into FOLDER
 *
 * Fails where a compensated form exceeds its family's allowance or decides anything wrongly.
 */
#include <math.h>
#include <string.h>

#include "check.h"
#include "hard_inputs.h"
#include "probe.h"
#include "tally.h"

enum { N_INPUTS = 2000, N_COLLECTED = 200000, N_FORMS = 3 };

static const probe *const forms[N_FORMS] = {&probe_f32, &probe_f64, &probe_f64c};

/* One unit in the last place of x > 0. */
static double ulp(double x, int digits) { return ldexp(1, ilogb(x) + 1 - digits); }

static double apart(const double a[2], const double b[2]) {
  return fabs((a[0] - b[0]) + (a[1] - b[1]));
}

/* `slack` is what a claim allows beyond its relative error, in the same units. */
static outcome sphere(const probe *p, const double *in, double *error, double *slack) {
  double got[2], roots[2][2];
  int n = TRUTH.sphere(in, in + 3, in + 6, in[9], roots);
  p->sphere(in, in + 3, in + 6, in[9], 0, got);
  int chosen = n == 0 ? 2 : roots[0][0] > 0 ? 0 : roots[1][0] > 0 ? 1 : 2;
  if (chosen == 2) return got[0] > 0 ? FALSE_HIT : AGREES;
  if (!(got[0] > 0)) return MISS;
  if (apart(got, roots[1 - chosen]) < apart(got, roots[chosen])) return WRONG_ROOT;
  double unit = ulp(roots[chosen][0], p->digits);
  *error = apart(got, roots[chosen]) / unit;
  *slack = 64 * p->unit * p->unit * in[9] * in[9] / fabs(roots[1 - chosen][0]) / unit;
  return AGREES;
}

static outcome plane(const probe *p, const double *in, double *error, double *slack) {
  (void)slack;
  double got[2], want[2];
  int hits = TRUTH.plane(in, in + 3, in + 6, in + 9, want) && want[0] > 0;
  p->plane(in, in + 3, in + 6, in + 9, got);
  if (!hits) return got[0] > 0 ? FALSE_HIT : AGREES;
  if (!(got[0] > 0)) return MISS;
  *error = apart(got, want) / ulp(want[0], p->digits);
  return AGREES;
}

static outcome refraction(const probe *p, const double *in, double *error, double *slack) {
  (void)slack;
  double got[3], want[3], most = 0;
  int passes = TRUTH.refraction(in, in + 3, in[6], in[7], in[8], want);
  int does = p->refraction(in, in + 3, in[6], in[7], in[8], got);
  if (does != passes) return does ? FALSE_HIT : MISS;
  for (int k = 0; passes && k < 3; k++) most = fmax(most, fabs(got[k] - want[k]));
  *error = most / p->unit;
  return AGREES;
}

static outcome shine(const probe *p, const double *in, double *error, double *slack) {
  (void)slack;
  double want[2], exponent;
  TRUTH.highlight(in, in + 3, in[6], want, &exponent);
  if (want[0] < 0x1p-100) return AGREES;
  double got[2] = {p->highlight(in, in + 3, in[6]), 0};
  *error = apart(got, want) / want[0] / p->unit / (1 + fabs(exponent));
  return AGREES;
}

typedef struct primitive {
  const char *name, *unit;
  outcome (*judge)(const probe *p, const double *input, double *error, double *slack);
  const family *families;
  const size_t *n_families;
  int n_numbers; /* of an input */
} primitive;

static const primitive primitives[] = {
    {"sphere", "ulp of t", sphere, sphere_families, &n_sphere_families, 10},
    {"plane", "ulp of t", plane, plane_families, &n_plane_families, 12},
    {"refract", "u, components", refraction, refract_families, &n_refract_families, 9},
    {"highlight", "u (1 + |eta ln x|)", shine, highlight_families, &n_highlight_families, 7},
};

/* Judges one input of a family; in float the input is what float makes of it. */
static void judge(const primitive *what, const probe *p, const double *input, double allowed,
                  tally *t) {
  double rounded[MAX_INPUT], error = 0, slack = 0;
  for (int i = 0; i < MAX_INPUT; i++)
    rounded[i] = p->digits == 24 ? (double)(float)input[i] : input[i];
  outcome decision = what->judge(p, rounded, &error, &slack);
  tally_add(t, decision, error, input);
  t->n_beyond += decision == AGREES && !(error <= allowed + slack);
}

static void keep(FILE *file, const primitive *what, const family *f, const double *input) {
  for (int i = 0; i < what->n_numbers; i++) fprintf(file, "%a ", input[i]);
  double plain = 0, compensated = 0, slack;
  outcome decision = what->judge(&probe_f64, input, &plain, &slack);
  what->judge(&probe_f64c, input, &compensated, &slack);
  fprintf(file, "# %s: compensated %.3g, plain ", f->name, compensated);
  if (decision == AGREES)
    fprintf(file, "%.3g\n", plain);
  else
    fprintf(file, "decides wrongly\n");
}

static int run_families(const primitive *what, FILE *file) {
  static tally t[N_FORMS];
  int n_bad = 0;
  printf("%s: p99 and worst error in %s, false hits/misses/wrong roots in 10^4\n%-33s", what->name,
         what->unit, "");
  for (int k = 0; k < N_FORMS; k++) printf("   %-33s", forms[k]->name);
  printf("\n");
  for (size_t i = 0; i < *what->n_families; i++) {
    const family *f = &what->families[i];
    for (int k = 0; k < N_FORMS; k++) tally_clear(&t[k]);
    for (int n = 0; n < (file ? N_COLLECTED : N_INPUTS); n++) {
      double input[MAX_INPUT] = {0};
      f->make(f->a, f->b, input);
      for (int k = 0; k < N_FORMS; k++) judge(what, forms[k], input, f->allowed, &t[k]);
    }
    printf("%-33s", f->name);
    for (int k = 0; k < N_FORMS; k++) tally_print(&t[k]);
    int bad = t[2].n_beyond > 0 || tally_n_wrong(&t[2]) > 0;
    printf("%s\n", bad ? "  FAILED" : "");
    n_bad += bad;
    if (!file) continue;
    keep(file, what, f, t[1].worst_input);
    keep(file, what, f, t[2].worst_input);
  }
  return n_bad;
}

/* One line a case: the numbers, then a comment that begins with the family's name. */
static int replay(const primitive *what, FILE *file) {
  char line[2048];
  int n_bad = 0, n_lines = 0;
  while (fgets(line, sizeof line, file)) {
    double input[MAX_INPUT] = {0}, error = 0, slack = 0;
    char *at = line;
    for (int i = 0; i < what->n_numbers; i++) input[i] = strtod(at, &at);
    const family *f = NULL;
    for (size_t i = 0; i < *what->n_families; i++) {
      const char *name = what->families[i].name;
      if (strncmp(at, " # ", 3) == 0 && strncmp(at + 3, name, strlen(name)) == 0 &&
          at[3 + strlen(name)] == ':')
        f = &what->families[i];
    }
    CHECK(f != NULL);
    n_lines++;
    if (what->judge(&probe_f64c, input, &error, &slack) == AGREES && error <= f->allowed + slack)
      continue;
    printf("%s: %s: the worst input kept errs by %g\n", what->name, f->name, error);
    n_bad++;
  }
  CHECK(n_lines > 0);
  return n_bad;
}

int main(int n_arguments, char **arguments) {
  int n_bad = 0, collects = n_arguments > 2;
  CHECK(n_arguments > 1);
  for (size_t i = 0; i < sizeof primitives / sizeof *primitives; i++) {
    char path[1024];
    snprintf(path, sizeof path, "%s/%s.txt", arguments[1], primitives[i].name);
    FILE *file = fopen(path, collects ? "w" : "r");
    CHECK(file != NULL);
    n_bad += run_families(&primitives[i], collects ? file : NULL);
    if (!collects) n_bad += replay(&primitives[i], file);
    fclose(file);
  }
  return n_bad > 0;
}
