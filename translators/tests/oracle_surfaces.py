"""Where the oracle's rays meet spheres and planes, and how narrowly each decision was made.

Arrays of vectors are (m, 3), of distances (m,). A **margin** is a dimensionless number: how far the
quantity that decided was from deciding otherwise: a discriminant over r², the cosine to a plane, a
distance or a difference of distances over a thousandth of the size of the coordinates (rounding
errs by far less there than under a square root, and ε itself is no narrow decision). 0: exactly on
an edge; ∞: nothing near.
"""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import numpy as np
from oracle_scene import Thing

Floats = Any

#: Mitsuba's constants as in its wheel: 1500 and 15000 half units in the last place of a float32.
RAY_EPSILON = 1500 * 2.0**-24
SHADOW_EPSILON = 15000 * 2.0**-24
NEAR_CLIP = 1e-2

#: Where a ray along a plane would meet it, were it tilted by a rounding error: after all else.
BEYOND = 1e300


def dot(a: Floats, b: Floats) -> Floats:
    """Inner product over the last axis."""
    return a[..., 0] * b[..., 0] + a[..., 1] * b[..., 1] + a[..., 2] * b[..., 2]


def unit(a: Floats) -> Floats:
    """Length 1 over the last axis; the zero vector stays."""
    length = np.sqrt(dot(a, a))
    return a / np.where(length == 0, 1, length)[..., None]


def lies_on(eye: tuple[float, ...], thing: Thing) -> bool:
    """Whether the eye is on the surface: the exact residual within 4 ulp of the magnitudes."""
    e, p = [Fraction(x) for x in eye], [Fraction(x) for x in thing.where]
    if thing.sphere:
        r = Fraction(thing.radius)
        residual = sum((a - b) ** 2 for a, b in zip(e, p, strict=True)) - r * r
        size = sum((abs(a) + abs(b)) ** 2 for a, b in zip(e, p, strict=True)) + r * r
    else:
        n = [Fraction(x) for x in thing.normal]
        residual = sum(c * (a - b) for a, b, c in zip(e, p, n, strict=True))
        size = sum(abs(c) * (abs(a) + abs(b)) for a, b, c in zip(e, p, n, strict=True))
    return bool(abs(residual) <= 4 * Fraction(2) ** -52 * size)


def roots(thing: Thing, o: Floats, d: Floats, on_surface: bool = False) -> tuple[Floats, ...]:
    """Return (near root, far root, margin, distance): NaN where there is none.

    The sphere's discriminant is r² − |perpendicular|², free of the cancellation of b² − c; `margin`
    says how surely the roots exist, `distance` where the line comes closest or meets. With
    `on_surface` the root 0 is left out.
    """
    kind = d.dtype
    where = np.array(thing.where, kind)
    if thing.sphere:
        r = kind.type(thing.radius)
        oc = np.broadcast_to(o - where, d.shape)
        b = -dot(oc, d)
        perpendicular = oc + b[:, None] * d
        disc = r * r - dot(perpendicular, perpendicular)
        margin = np.abs(disc) / (r * r)
        far_out = np.sqrt(dot(oc, oc))
        c = (far_out - r) * (far_out + r)
        q = b + np.copysign(np.sqrt(np.where(disc < 0, np.nan, disc)), b)
        other = np.where(q == 0, 0, c / np.where(q == 0, 1, q))
        other = np.where(np.isnan(q), np.nan, other)
        if on_surface:
            twice = np.where(np.isnan(q), np.nan, 2 * b)
            return np.full_like(q, np.nan), twice, margin, b
        return np.minimum(q, other), np.maximum(q, other), margin, b
    n = unit(np.array(thing.normal, kind))
    slope = dot(d, n)
    if on_surface:
        none = np.full(len(d), np.nan, kind)
        return none, none, np.full(len(d), np.inf, kind), none
    t = np.where(slope == 0, np.nan, dot(where - o, n) / np.where(slope == 0, 1, slope))
    height = np.abs(dot(where - o, n)) + np.zeros_like(slope)
    reach = np.where(slope == 0, BEYOND, height / np.where(slope == 0, 1, np.abs(slope)))
    return np.full_like(t, np.nan), t, np.abs(slope), reach


def _scale(o: Floats, t: Floats) -> Floats:
    return 1e-3 * (1 + np.abs(o).max(axis=-1) + np.where(np.isfinite(t), np.abs(t), 0))


def nearest(
    things: list[Thing], o: Floats, d: Floats, far: float, on_surface: list[bool] | None = None
) -> tuple[Floats, Floats, Floats]:
    """Return (index of the thing hit or −1, t, margin); of equal t the first in the file."""
    o = np.broadcast_to(o, d.shape)
    best = np.full(len(d), np.inf, d.dtype)
    index = np.full(len(d), -1)
    found = []
    for i, thing in enumerate(things):
        first, last, surely, reach = roots(thing, o, d, on_surface is not None and on_surface[i])
        t = np.where(first > 0, first, np.where(last > 0, last, np.inf))
        t = np.where(t > far, np.inf, t)
        index = np.where(t < best, i, index)
        best = np.minimum(t, best)
        gaps = [np.abs(first), np.abs(last), np.abs(first - far), np.abs(last - far)]
        zero = np.fmin.reduce(gaps) / _scale(o, np.zeros_like(t))
        margin = np.fmin(np.where(np.isnan(zero), np.inf, zero), surely)
        # A miss matters where the line comes closest ahead, a hit where it is, a root at 0 always.
        ahead = np.where(np.isfinite(t), t, np.where(reach > 0, reach, np.inf))
        found.append((t, margin, np.where(zero < 1e-4, 0, ahead)))
    margin = np.full(len(d), np.inf, d.dtype)
    for i, (t, surely, ahead) in enumerate(found):
        relevant = (ahead <= best) & np.isfinite(ahead)
        margin = np.where(relevant, np.minimum(margin, surely), margin)
        # Another thing as near as the nearest is an edge, but its twin is not: first in the file.
        twins = [j for j, thing in enumerate(things) if thing.shape == things[i].shape]
        rival = np.isfinite(t) & ~np.isin(index, twins)
        gap = np.where(rival, t, 0) - np.where(rival, best, 0)
        margin = np.where(rival, np.minimum(margin, gap / _scale(o, best)), margin)
    return index, best, margin


def blocked(
    things: list[Thing], o: Floats, d: Floats, least: float, limit: Floats
) -> tuple[Floats, Floats]:
    """Return (whether anything lies at least < t < limit, margin) for each shadow ray.

    One sure blocker settles it, so the margin of a shadow is its surest blocker's.
    """
    shadow = np.zeros(len(d), bool)
    lit_margin = np.full(len(d), np.inf, d.dtype)
    shadow_margin = np.zeros(len(d), d.dtype)
    for thing in things:
        near, far, surely, reach = roots(thing, o, d)
        hit = ((near > least) & (near < limit)) | ((far > least) & (far < limit))
        scale = _scale(o, limit)
        gaps = [
            np.abs(near - least),
            np.abs(far - least),
            np.abs(near - limit),
            np.abs(far - limit),
        ]
        margin = np.where(np.isnan(far), np.inf, np.fmin.reduce(gaps) / scale)
        near_miss = (reach > 0) & (reach < limit * (1 + 1e-6))
        margin = np.where(hit | near_miss, np.fmin(margin, surely), margin)
        shadow_margin = np.where(hit, np.maximum(shadow_margin, margin), shadow_margin)
        lit_margin = np.where(hit, lit_margin, np.minimum(lit_margin, margin))
        shadow |= hit
    return shadow, np.where(shadow, shadow_margin, lit_margin)
