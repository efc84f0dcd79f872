/* The camera basis where `up` is nearly parallel to the view: set up in the widest type it keeps
 * double's digits down to an angle of 1e-12, where plain double has none left. */
#include <math.h>

#include "check.h"
#include "frame.h"
#include "random.h"
#include "test_options.h"

static void cross(const double a[3], const double b[3], double out[3]) {
  for (int i = 0; i < 3; i++)
    out[i] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
}

static void normalise(double a[3]) {
  double length = sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
  for (int i = 0; i < 3; i++) a[i] /= length;
}

/* The error of u as double computes it, given the frame's. */
static double plain_error(const ct_scene_view *v, const ct_frame *frame) {
  double w[3], up[3], u[3], most = 0;
  for (int i = 0; i < 3; i++) w[i] = v->eye[i] - v->target[i], up[i] = v->up[i];
  normalise(w);
  normalise(up);
  cross(up, w, u);
  normalise(u);
  for (int i = 0; i < 3; i++) most = fmax(most, fabs((double)(u[i] - frame->u[i])));
  return most;
}

/* u computed another way: the cross product of the inputs as they stand, made of length 1 by the
 * first two steps of a series, as its length is nearly known. */
static double wide_error(const ct_scene_view *v, const ct_frame *frame) {
  ct_wide w[3], c[3], length2 = 0;
  double most = 0;
  for (int i = 0; i < 3; i++) w[i] = (ct_wide)v->eye[i] - (ct_wide)v->target[i];
  for (int i = 0; i < 3; i++) {
    int j = (i + 1) % 3, k = (i + 2) % 3;
    c[i] = (ct_wide)v->up[j] * w[k] - (ct_wide)v->up[k] * w[j];
    length2 += c[i] * c[i];
  }
  double start = 1 / sqrt((double)length2);
  ct_wide scale = start;
  for (int n = 0; n < 3; n++) scale += scale * (1 - length2 * scale * scale) / 2;
  for (int i = 0; i < 3; i++)
    most = fmax(most, fabs((double)(c[i] * scale - frame->u[i])));
  return most;
}

int main(void) {
  ct_options *options = test_options();
  const double wide_unit = sizeof(ct_wide) == 16 && (ct_wide)1 + (ct_wide)0x1p-100 > 1 ? 0x1p-113
                                                                                      : 0x1p-64;
  for (double angle = 1e-2; angle > 0.9e-12; angle /= 100) {
    double worst_plain = 0, worst_wide = 0;
    for (int n = 0; n < 200; n++) {
      ct_scene_view v = {.delivery = 1, .v_res = 1, .h_res = 1, .pixel_size = 1,
                         .screen_distance = 1};
      ct_frame frame;
      double view[3], across[3];
      random_direction(view);
      random_normal_to(view, across);
      for (int i = 0; i < 3; i++) {
        v.target[i] = uniform_in(-10, 10);
        v.eye[i] = v.target[i] + 7 * view[i];
        v.up[i] = view[i] + angle * across[i];
      }
      CHECK(ct_frame_open(&frame, &v, options) == CT_OK);
      worst_plain = fmax(worst_plain, plain_error(&v, &frame));
      worst_wide = fmax(worst_wide, wide_error(&v, &frame));
      ct_frame_close(&frame);
    }
    printf("up at %.0e from the view: error of u %.1e plain, %.1e in the widest type\n", angle,
           worst_plain, worst_wide);
    CHECK(worst_wide <= 32 * wide_unit / angle);
  }
  ct_options_free(options);
  return 0;
}
