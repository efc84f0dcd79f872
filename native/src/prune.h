/* How little a secondary ray can bring to its pixel, so that it need not be traced. Internal.
 *
 * Let V(r) bound every channel of whatever a ray returns that may bounce r times more. Local light
 * of object i is at most
 *   l_i = ka c a + (kd c + ks h) * (sum over the lights of their colour),
 * as no cosine exceeds 1 and no light counts when it is blocked; h bounds a highlight, 1 but for
 * rounding, which eta magnifies. Its secondary rays weigh at most k_i = kr + kt together, or 1 of a
 * total reflection where that is more. So
 *   V(0) = max(b, max_i (l_i + k_i e)),   V(r) = max(b, max_i (l_i + k_i V(r - 1))),
 * with the background b and e what stands for a ray that the depth forbids (0, or b under
 * exhausted=background). Every channel is carried by itself; V is the greatest of the three.
 *
 * A ray carries a slack s: how much smaller each channel of what it returns may become. A primary
 * ray has the tolerance T. At a hit with branches of weights k1, k2, which can bring at most
 * k1 V and k2 V:
 *   both together at most s: neither is traced;
 *   else, where the smaller alone is at most s, it is not traced, and s shrinks by what it could
 *   have brought;
 *   what is left of s goes to the branch that is traced, or half to each; a branch of weight k has
 *   its part / k as its own slack.
 * By induction over the tree a ray returns at most s less: what is dropped and the weight * slack of
 * what is traced make up s. (Halves spare more rays than parts in proportion to the weights: they
 * favour the lighter branch, whose rays cost as much and matter less.) So a pixel loses at most T in all, however many branches are
 * dropped, and as light is never negative it loses and never gains.
 *
 * In floating point both sums are rounded, each by at most 3 operations a level, and so is the
 * slack: T is lessened at first by 8 units of it and of V for every level. A T below that prunes
 * nothing.
 *
 * Nothing is pruned either where a reading lets light be negative, scales it, sends rays without
 * a bounce, or takes normals of any length: mix=convex, recursion=scale, nesting=interiors,
 * plane_normal=raw.
 */
#ifndef CT_PRUNE_H
#define CT_PRUNE_H

#include "frame.h"

typedef struct ct_reach {
  double slack;     /* of a primary ray, lessened for rounding; 0: nothing is pruned */
  size_t n_bounces; /* of `most`; the last entry holds for more bounces, too */
  double *most;     /* V by the number of bounces left */
} ct_reach;

/* `unit` is the relative error of one operation of the kernel that asks. */
ct_status ct_reach_open(ct_reach *reach, const ct_frame *frame, double unit);
void ct_reach_close(ct_reach *reach);

#endif
