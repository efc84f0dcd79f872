/* prune.inc.h for rays side by side. */

/* Takes rays that are left out from `back` and `through`. Returns the part of the slack that each of
 * the others has. */
INLINE LANES prune_lanes(LANES spare, REAL most, LANES kr, LANES kt, MASK *back, MASK *through) {
  LANES v = l_all(most), backward = kr * v, forward = kt * v, zero = l_all(0);
  MASK none = l_at_most(backward + forward, spare);
  MASK is_back = l_less(backward, forward);
  LANES smaller = l_blend(is_back, backward, forward);
  MASK one = m_but(l_at_most(smaller, spare), none);
  spare = l_blend(one, spare - smaller, spare);
  *back = m_but(m_but(*back, none), m_and(one, is_back));
  *through = m_but(m_but(*through, none), m_but(one, is_back));
  MASK both = m_and(m_and(*back, l_less(zero, kr)), m_and(*through, l_less(zero, kt)));
  return l_blend(both, l_all((REAL)0.5) * spare, spare);
}
