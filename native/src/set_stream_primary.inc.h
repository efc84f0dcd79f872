/* The rays from the eye through the centres of pixels (specification 2.3). */

static void primary_vector(const SWORLD *world, const double *row, const double *column,
                           STREAM *rays, int at) {
  const WORLD *base = world->base;
  const ct_scene_view *view = base->view;
  const IV basis[3][3] = {{base->u.x, base->v.x, base->w.x},
                          {base->u.y, base->v.y, base->w.y},
                          {base->u.z, base->v.z, base->w.z}};
  double size = view->pixel_size, distance = view->screen_distance;
  /* Halves of integers: exact. */
  LANES across = l_load(column) - (double)view->h_res / 2 + 0.5;
  LANES down = l_load(row) - (double)view->v_res / 2 + 0.5;
  VI x = vi(-across * size, across * size), y = vi(down * size, -down * size);
  VI z = vi(l_all(distance), l_all(-distance));
  VI q = vi_add(vi_add(vi_square(x), vi_square(y)), vi_square(z));
  LENGTH length = length_of(q);
  VI direction[3], origin[3];
  for (int k = 0; k < 3; k++) {
    const IV *b = basis[k];
    VI way = vi_add(vi_add(vi_mul(vi_from(b[0]), x), vi_mul(vi_from(b[1]), y)),
                    vi_mul(vi_from(b[2]), z));
    direction[k] = vi_by_positive(length.inverse, way);
    origin[k] = vi(l_all(-view->eye[k]), l_all(view->eye[k]));
  }
  if (base->choice[CT_OFFSET] == CT_OFFSET_MITSUBA) {
    IV near = i_over_positive(i_from(SET_MITSUBA_NEAR), i_from(distance));
    VI step = vi_of_positives(vi_from(near), length.length);
    for (int k = 0; k < 3; k++)
      origin[k] = vi_add(origin[k], vi_by_positive(step, direction[k]));
  }
  for (int k = 0; k < 3; k++) {
    l_store(rays->origin[k] + at, origin[k].n);
    l_store(rays->origin[3 + k] + at, origin[k].h);
    l_store(rays->direction[k] + at, direction[k].n);
    l_store(rays->direction[3 + k] + at, direction[k].h);
  }
}

/* One ray a pixel. Room beyond the last is filled, too. */
static void aim(const SWORLD *world, const int64_t *pixels, int n, STREAM *rays) {
  int64_t h_res = world->base->view->h_res, last = -2, of_row = 0, of_column = 0;
  double row[ROOM], column[ROOM];
  rays->n = n;
  for (int i = 0; i < ROOM; i++) {
    int at = i < n ? i : n - 1;
    if (pixels[at] == last + 1 && of_column + 1 < h_res) {
      of_column++; /* most follow one another, and a division takes long */
    } else if (pixels[at] != last) {
      of_row = pixels[at] / h_res;
      of_column = pixels[at] % h_res;
    }
    last = pixels[at];
    row[i] = (double)of_row;
    column[i] = (double)of_column;
    rays->slot[i] = at;
    rays->medium[i] = world->base->frame->eye_medium;
  }
  for (int at = 0; at < n; at += N_LANES)
    primary_vector(world, row + at, column + at, rays, at);
}
