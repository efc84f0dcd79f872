/* Which branches of a hit are left out because their pixel would hardly notice: prune.h, for one
 * scalar type. stream_prune.inc.h has the same operations side by side. */

/* The most that a ray of that depth can return. */
static inline REAL most_returned(const WORLD *world, int64_t depth) {
  size_t left = (size_t)(world->frame->max_depth - depth), last = world->reach.n_bounces - 1;
  return from_double(world->reach.most[left < last ? left : last]);
}

/* Sets the weights of branches that are left out to 0. Returns the part of the slack that each of the
 * others has, in units of this ray. */
static REAL prune(const WORLD *world, const RAY *ray, REAL *kr, REAL *kt) {
  REAL zero = from_double(0), most = most_returned(world, ray->depth + 1), spare = ray->slack;
  REAL back = mul(*kr, most), through = mul(*kt, most);
  if (!less(spare, add(back, through))) {
    *kr = *kt = zero;
    return zero;
  }
  int is_back = less(back, through); /* the smaller one */
  REAL smaller = is_back ? back : through;
  if (!less(spare, smaller)) {
    *(is_back ? kr : kt) = zero;
    spare = sub(spare, smaller);
  }
  return less(zero, *kr) && less(zero, *kt) ? mul(from_double(0.5), spare) : spare;
}
