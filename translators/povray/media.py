"""Refraction indices for a renderer that keeps a list of the media a ray is in.

The specification's n belongs to a surface: crossing it always divides by n or multiplies by it,
whatever it is nested in. POV-Ray gives an *interior* to an object and refracts by the ratio of the
interiors' indices before and after, so that the product of ratios along a path is always 1 over the
index of the interior the ray is in. Both agree when every interior holds an absolute index: the
product of n over all transparent objects around the region behind the surface, relative to the
region of the camera, which is POV-Ray's "no interior".

Seen from the camera, every surface has a *far side*. Surfaces that do not cross have far sides that
are nested or disjoint, so each far side has one index just behind its surface:
``ior_i = f_i · Π f_j`` over the far sides j that hold surface i, where f is n if the far side is
the object's inside and 1/n otherwise. For surfaces that cross no such index exists (the indices
here then take crossing surfaces as not nested), and the ledger says so.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from crosstrace.translators.errors import UnsupportedSceneError
from crosstrace.translators.povray.camera import CameraSide
from crosstrace.translators.povray.plan import Plan
from crosstrace.translators.scene import KT, N

#: So many surfaces are compared at once with those that they may meet.
_BLOCK = 128

#: POV-Ray keeps an index as a float; outside this range its products and quotients overflow.
_INDEX_RANGE = (1e-18, 1e18)


@dataclass(frozen=True)
class Media:
    """Indices relative to the camera's region, and the surfaces that have no exact one.

    `ior` (n,) float32 is 1 for opaque surfaces; `crossing` lists rows of the plan that cross
    another transparent surface; `nudged` rows whose index is one float32 step off, see `media`.
    """

    ior: NDArray[np.float32]
    crossing: NDArray[np.intp]
    nudged: NDArray[np.intp]


def media(plan: Plan, side: CameraSide) -> Media:
    """Work out the indices; raises UnsupportedSceneError where float32 cannot hold one.

    Where the index does not change at a surface (n = 1), POV-Ray would continue the ray without
    counting it as a bounce; its index is then taken one float32 step off.
    """
    rows = np.flatnonzero(plan.material[:, KT] > 0)
    ior = np.ones(len(plan), np.float32)
    none = np.zeros(0, np.intp)
    if not len(rows):
        return Media(ior, none, none)
    n = plan.material[rows, N]
    factor = np.where(side.inside[rows], 1 / n, n)
    parents, crosses = _around(plan, rows, side.inside[rows])
    nudged = []
    # From the outermost inwards: a parent has fewer surfaces around it than its child.
    for i in np.argsort([len(p) for p in parents], kind="stable"):
        product = float(np.prod(np.sort(np.append(factor[parents[i]], factor[i]))))
        if not _INDEX_RANGE[0] < product < _INDEX_RANGE[1]:
            raise UnsupportedSceneError(
                f"POV-Ray keeps refraction indices in float32: object {plan.index[rows[i]] + 1} "
                f"needs {product:.3g} relative to the camera"
            )
        index = np.float32(product)
        innermost = max(parents[i], key=lambda j: len(parents[j]), default=None)
        outer = np.float32(1) if innermost is None else ior[rows[innermost]]
        if abs(float(outer) / float(index) - 1) < 2e-8:
            index = np.nextafter(outer, np.float32(np.inf))
            nudged.append(rows[i])
        ior[rows[i]] = index
    return Media(ior, rows[crosses], np.array(nudged, np.intp))


def _around(
    plan: Plan, rows: NDArray[np.intp], camera_inside: NDArray[np.bool_]
) -> tuple[list[NDArray[np.intp]], NDArray[np.bool_]]:
    """Return for each transparent surface the far sides that hold it, and whether it crosses one.

    Positions are within `rows`.
    """
    parents = [np.zeros(0, np.intp)] * len(rows)
    crosses = np.zeros(len(rows), bool)
    # Sweep along x: surfaces whose extents are apart are outside of each other, which is no news
    # except where the camera's side is the inner one.
    radius = np.where(plan.sphere[rows], plan.geometry[rows, 3], np.inf)
    low, high = plan.geometry[rows, 0] - radius, plan.geometry[rows, 0] + radius
    order = np.argsort(low, kind="stable")
    for start in range(0, len(rows), _BLOCK):
        block = order[start : start + _BLOCK]
        near = (low <= high[block].max()) & (high >= low[block].min())
        others = np.flatnonzero(near | camera_inside)
        inside, outside = _placed(plan, rows[block], rows[others])
        itself = block[:, None] == others
        crosses[block] = (~inside & ~outside & ~itself).any(axis=1)
        far = np.where(camera_inside[others], outside, inside) & ~itself
        for i, row in zip(block, far, strict=True):
            parents[i] = others[row]
    return parents, crosses


def _placed(
    plan: Plan, those: NDArray[np.intp], others: NDArray[np.intp]
) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Say which surfaces lie wholly inside, and wholly outside, which objects: two (a, b) masks."""
    a, b = plan.geometry[those][:, None], plan.geometry[others][None]
    ball_a, ball_b = plan.sphere[those][:, None], plan.sphere[others][None]
    radius_a, radius_b = a[..., 3], b[..., 3]

    squared = sum((a[..., k] - b[..., k]) ** 2 for k in range(3))
    distance = np.sqrt(squared)
    inside = distance + radius_a <= radius_b
    outside = (distance >= radius_a + radius_b) | (distance + radius_b <= radius_a)
    if ball_a.all() and ball_b.all():
        return inside, outside

    # Against a plane: the height of the ball's centre, or of a parallel plane's point.
    height = ((a[..., :3] - b[..., :3]) * b[..., 3:]).sum(axis=-1)
    parallel = np.abs(np.cross(a[..., 3:], b[..., 3:])).max(axis=-1) <= 4e-16
    margin = np.where(ball_a, radius_a, 0.0)
    clear = ball_a | parallel
    inside = np.where(ball_b, ball_a & inside, clear & (height <= -margin))
    # A plane is never inside a ball; it crosses the ball or stays outside of it.
    rise = np.abs(((b[..., :3] - a[..., :3]) * a[..., 3:]).sum(axis=-1))
    beside = np.where(ball_a, outside, rise >= radius_b)
    outside = np.where(ball_b, beside, clear & (height >= margin))
    return inside, outside
