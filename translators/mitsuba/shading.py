"""Phong terms, reflection and refraction on Dr.Jit arrays, written once for both precisions.

The formulas are those of 3.2, 4.1 and 4.2 of the specification. Every function takes arrays of one
precision (`Float` with `Vector3f`, or `Float64` with `Vector3d`) and is traced into a kernel; the
precision is that of its arguments. Directions are of length 1.

No `dr.minimum`, `dr.maximum` or `dr.power`: the first two abort the process under LLVM 15 and 16,
the third gives infinities where the true power is subnormal (Dr.Jit 1.5).
"""

from __future__ import annotations

from typing import Any

import drjit as dr

LOG2_E = 1.4426950408889634
#: A highlight of less than 2 to this is none: far below any image's digits, in both precisions.
LEAST_POWER = -120.0


def positive(x: Any) -> Any:
    """Return max(0, x); 0 where x is not a number."""
    return dr.select(x > 0, x, 0)


def mirrored(direction: Any, normal: Any) -> Any:
    """Return 2(n·d)n − d: the direction on the other side of the normal."""
    return 2 * dr.dot(normal, direction) * normal - direction


def power_of_cosine(a: Any, b: Any, exponent: Any) -> Any:
    """Return max(0, a·b)^exponent, 0 where a·b ≤ 0; the exponent is positive, whole or not.

    Near 1 the rounding of a·b would be magnified by the exponent, so the logarithm is taken of
    1 − h with h = |a − b|²/2, the same number for unit vectors: log2(1 − h) through the rounded
    u = 1 − h, corrected by h/(1 − u). The relative error stays at a few units in the last place up
    to exponents of a million, instead of the exponent times that.
    """
    cosine = dr.dot(a, b)
    h = 0.5 * dr.squared_norm(a - b)
    u = 1 - h
    near = dr.select(u < 1, dr.log2(u) * (h / (1 - u)), -LOG2_E * h)
    log2_cosine = dr.select(h < 0.5, near, dr.log2(cosine))
    power = exponent * log2_cosine
    # Dr.Jit's exp2 is not a number far below the smallest exponent; that highlight is black.
    shown = (cosine > 0) & (power > LEAST_POWER)
    return dr.select(shown, dr.exp2(dr.select(shown, power, 0)), 0)


def bend(cosine: Any, index: Any) -> tuple[Any, Any, Any]:
    """Work out the refraction of a ray (4.2): return (m, Δ, a) with t = −m·ωo − a·n.

    `cosine` is n·ωo, `index` the relative index n of the inner side. The observer is outside where
    n·ωo > 0 and inside otherwise; m is 1/n outside and n inside, n itself being the index of the
    turned side's inverse. `a` has the sign that fits the normal as given. Total reflection: Δ < 0.
    """
    outside = cosine > 0
    m = dr.select(outside, 1 / index, index)
    facing = dr.abs(cosine)
    delta = 1 - m * m * ((1 - facing) * (1 + facing))
    along = dr.sqrt(positive(delta)) - m * facing
    return m, delta, dr.select(outside, along, -along)
