/* Which frames the certified streams take, and which instruction set runs them. */
#include "set_stream.h"

#include <math.h>

#if defined(CT_HAVE_LANES)
extern const ct_set_stream ct_set_stream_generic;
#endif
#if defined(CT_HAVE_LANES_AVX2)
extern const ct_set_stream ct_set_stream_avx2;
#endif
#if defined(CT_HAVE_LANES_AVX512)
extern const ct_set_stream ct_set_stream_avx512;
#endif

/* Products of four such numbers are far from overflow, their quotients and squares from underflow:
 * the streams do no other checks for either. */
#define LARGEST 0x1p200
#define SMALLEST 0x1p-200

static int fits(double x) { return fabs(x) <= LARGEST; }

static int holds_point(const double *p) { return fits(p[0]) && fits(p[1]) && fits(p[2]); }

static int holds_numbers(const ct_frame *frame) {
  const ct_scene_view *v = &frame->view;
  const ct_options *options = frame->options;
  if (!holds_point(v->eye) || !fits(v->screen_distance) || v->screen_distance < SMALLEST ||
      v->pixel_size < SMALLEST ||
      !fits(v->pixel_size * ((double)v->h_res + (double)v->v_res)) ||
      options->epsilon > LARGEST || options->shadow_min > LARGEST || options->light_min > LARGEST)
    return 0;
  for (size_t j = 0; j < v->n_lights; j++)
    if (!holds_point(v->lights + j * CT_LIGHT_COLUMNS + 3)) return 0;
  for (size_t i = 0; i < v->n_objects; i++) {
    const double *g = v->geometry + i * CT_GEOMETRY_COLUMNS;
    const double *m = v->material + i * CT_MATERIAL_COLUMNS;
    if (!holds_point(g) || !(m[CT_N] <= LARGEST)) return 0;
    if (m[CT_KT] > 0 && !(m[CT_N] >= SMALLEST)) return 0;
    if (v->kind[i] == CT_SPHERE) {
      if (!(g[3] >= SMALLEST && g[3] <= LARGEST)) return 0;
      continue;
    }
    double n = fabs(g[3]) + fabs(g[4]) + fabs(g[5]);
    if (!(n >= SMALLEST && n <= LARGEST)) return 0;
  }
  return 1;
}

static int knows_readings(const ct_frame *frame) {
  const int *choice = frame->options->choice;
  for (int k = 0; k < CT_N_CHOICES; k++) {
    int is_known = choice[k] == 0 || k == CT_NESTING || k == CT_INDEX ||
                   (k == CT_OFFSET && choice[k] == CT_OFFSET_MITSUBA);
    if (!is_known) return 0;
  }
  return 1;
}

/* The streams know exactly where a shadow ray leaves its surface, and so decide what a rounding
 * tracer could not where it hardly leaves it at all. */
static int leaves_surfaces(const ct_options *options) {
  return options->epsilon >= 1e-20 || options->choice[CT_OFFSET] == CT_OFFSET_MITSUBA;
}

/* The root at an eye that lies on a sphere has a formula of its own. */
static int is_eye_on_sphere(const ct_frame *frame) {
  for (size_t i = 0; i < frame->view.n_objects; i++)
    if (frame->eye_on[i] && frame->view.kind[i] == CT_SPHERE) return 1;
  return 0;
}

const ct_set_stream *ct_set_stream_for(const ct_frame *frame) {
  if (!knows_readings(frame) || !leaves_surfaces(frame->options) || is_eye_on_sphere(frame) ||
      !holds_numbers(frame))
    return NULL;
  ct_instructions usable = ct_instructions_usable(frame->options->instructions);
#if defined(CT_HAVE_LANES_AVX512)
  if (usable >= CT_INSTRUCTIONS_AVX512) return &ct_set_stream_avx512;
#endif
#if defined(CT_HAVE_LANES_AVX2)
  if (usable >= CT_INSTRUCTIONS_AVX2) return &ct_set_stream_avx2;
#endif
  (void)usable;
#if defined(CT_HAVE_LANES)
  return &ct_set_stream_generic; /* under any cap: another text would have other bits */
#else
  return NULL;
#endif
}
