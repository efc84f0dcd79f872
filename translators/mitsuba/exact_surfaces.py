"""Spheres and planes in Dr.Jit Float64: nearest hit and shadow test, by a scan over the objects.

The objects stand in evaluated arrays, one set of columns for spheres and one for planes, so that a
kernel does not depend on how many there are. Nearest wins; at equal distance the object first in
the file. The eye's own surfaces (`camera.eye_on_…`) lose their zero root for primary rays.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import drjit as dr
import mitsuba as mi
import numpy as np
from numpy.typing import NDArray

from crosstrace.translators.mitsuba.camera import Array, eye_on_plane, eye_on_sphere, unit

NONE = 0xFFFFFFFF


@dataclass(frozen=True)
class Hit:
    """The nearest hit along each ray: distance (inf: none), object, point and unit normal."""

    distance: Any
    index: Any
    point: Any
    normal: Any


class Surfaces:
    """The geometry of a scene: `is_sphere` (k,), `geometry` (k, 6) as in `Scene.geometry`."""

    def __init__(self, is_sphere: NDArray[np.bool_], geometry: Array, eye: Array) -> None:
        """Normalise the planes' normals, decide where the eye lies, and upload everything."""
        table = np.array(geometry, np.float64).reshape(-1, 6)
        for i in np.flatnonzero(~is_sphere):
            table[i, 3:] = unit(table[i, 3:])
        balls, flats = np.flatnonzero(is_sphere), np.flatnonzero(~is_sphere)
        centers, radii = table[balls, :3], table[balls, 3]
        points, normals = table[flats, :3], table[flats, 3:]
        self._spheres = _Columns(table[balls, :4], balls, eye_on_sphere(eye, centers, radii))
        self._planes = _Columns(table[flats], flats, eye_on_plane(eye, points, normals))
        self._geometry = [_column(table[:, k]) for k in range(6)]
        self._is_sphere = _column(is_sphere.astype(np.uint32), mi.UInt32)

    def nearest(self, origin: Any, direction: Any, primary: Any, active: Any) -> Hit:
        """Return the nearest hit at t > 0 of each active ray."""
        best = dr.full(mi.Float64, math.inf, dr.width(direction))
        index = dr.full(mi.UInt32, NONE, dr.width(direction))
        for columns, test in ((self._spheres, _sphere), (self._planes, _plane)):
            best, index = _scan(columns, test, origin, direction, primary, active, best, index)
        return self._describe(origin, direction, best, index, active)

    def blocked(self, origin: Any, direction: Any, light: Any, distance: Any, active: Any) -> Any:
        """Say for which active rays any object lies strictly between origin and light.

        Decided by the sides on which the two ends lie and not by t < distance, so that a light
        exactly on a surface is not put into its shadow by rounding. No distance, no blocker.
        """
        hidden = dr.full(dr.mask_t(distance), False, dr.width(direction))
        ray = (origin, direction, light, distance)
        for columns, test in ((self._spheres, _sphere_between), (self._planes, _plane_between)):
            hidden = _any(columns, test, ray, active & (distance > 0), hidden)
        return hidden

    def _describe(self, o: Any, d: Any, t: Any, index: Any, active: Any) -> Hit:
        hit = active & (index != NONE)
        a = [dr.gather(mi.Float64, column, index, hit) for column in self._geometry]
        first, second = mi.Vector3d(*a[:3]), mi.Vector3d(*a[3:])
        ball = dr.gather(mi.UInt32, self._is_sphere, index, hit) == 1
        # The normal is built from the centre's own frame, where the point has the fewest digits,
        # and is of length 1 but for rounding, which would grow from bounce to bounce in glass.
        outward = (o - first) + t * d
        outward /= dr.norm(outward)
        return Hit(t, index, o + t * d, dr.select(ball, outward, second))


class _Columns:
    """The numbers of one kind of surface, column by column; empty tables hold one unused row."""

    def __init__(self, table: Array, index: Any, eye_on: NDArray[np.bool_]) -> None:
        self.numbers = [_column(table[:, k]) for k in range(table.shape[1])]
        self.index = _column(index.astype(np.uint32), mi.UInt32)
        self.eye_on = _column(eye_on.astype(np.uint32), mi.UInt32)
        self.count = dr.opaque(mi.UInt32, len(table))


def _column(values: NDArray[Any], kind: Any = None) -> Any:
    kind = kind or mi.Float64
    values = np.ascontiguousarray(values) if len(values) else np.zeros(1, values.dtype)
    return kind(values)


def _scan(
    columns: _Columns, test: Any, o: Any, d: Any, primary: Any, active: Any, best: Any, index: Any
) -> tuple[Any, Any]:
    def body(i: Any, best: Any, index: Any) -> Any:
        t, own, _ = test(columns, i, o, d, primary, active)
        # A plane that a ray runs parallel to lies at infinity: a miss, and no tie with "none yet".
        closer = active & (t > 0) & (t < math.inf) & ((t < best) | ((t == best) & (own < index)))
        return i + 1, dr.select(closer, t, best), dr.select(closer, own, index)

    state = (dr.zeros(mi.UInt32, dr.width(d)), best, index)
    loop = dr.while_loop(
        state, lambda i, *_: active & (i < columns.count), body, label=test.__name__
    )
    return loop[1], loop[2]


def _any(columns: _Columns, test: Any, ray: tuple[Any, ...], active: Any, hidden: Any) -> Any:
    def body(i: Any, hidden: Any) -> Any:
        numbers, _, _ = _row(columns, i, active & ~hidden)
        return i + 1, hidden | (active & test(numbers, *ray))

    state = (dr.zeros(mi.UInt32, dr.width(hidden)), hidden)
    return dr.while_loop(
        state, lambda i, hidden: active & ~hidden & (i < columns.count), body, label=test.__name__
    )[1]


def _row(columns: _Columns, i: Any, active: Any) -> tuple[list[Any], Any, Any]:
    numbers = [dr.gather(mi.Float64, column, i, active) for column in columns.numbers]
    own = dr.gather(mi.UInt32, columns.index, i, active)
    return numbers, own, dr.gather(mi.UInt32, columns.eye_on, i, active) == 1


def _sphere(columns: _Columns, i: Any, o: Any, d: Any, primary: Any, active: Any) -> Any:
    """Return the smallest positive root (not positive, or NaN: none), the object, eye on it.

    The discriminant is r² − |l|² with l the offset of the ray's closest point from the centre, and
    the roots are q and c/q, so that neither distance nor a huge radius cancels digits.
    """
    (x, y, z, radius), own, eye_on = _row(columns, i, active)
    f = o - mi.Vector3d(x, y, z)
    b = -dr.dot(f, d)
    apart = dr.fma(d, b, f)
    root = dr.sqrt(radius * radius - dr.squared_norm(apart))
    q = b + dr.select(b < 0, -root, root)
    other = (dr.squared_norm(f) - radius * radius) / q
    low, high = dr.select(other < q, other, q), dr.select(other < q, q, other)
    t = dr.select(low > 0, low, high)
    return dr.select(primary & eye_on, 2 * b, t), own, eye_on


def _plane(columns: _Columns, i: Any, o: Any, d: Any, primary: Any, active: Any) -> Any:
    """Return the distance (not positive, infinite or NaN: none), the object, whether eye on it."""
    (px, py, pz, nx, ny, nz), own, eye_on = _row(columns, i, active)
    n = mi.Vector3d(nx, ny, nz)
    t = dr.dot(mi.Vector3d(px, py, pz) - o, n) / dr.dot(d, n)
    return dr.select(primary & eye_on, -1, t), own, eye_on


def _sphere_between(numbers: list[Any], o: Any, d: Any, light: Any, distance: Any) -> Any:
    """Say whether the sphere's surface is met strictly between `o` and the light along `d`."""
    x, y, z, radius = numbers
    square = radius * radius
    center = mi.Vector3d(x, y, z)
    f = o - center
    from_o, from_light = dr.squared_norm(f) - square, dr.squared_norm(light - center) - square
    b = -dr.dot(f, d)
    through = (square - dr.squared_norm(dr.fma(d, b, f)) > 0) & (b > 0) & (b < distance)
    outside = dr.select(from_light < 0, True, through)
    return dr.select(from_o < 0, from_light > 0, outside)


def _plane_between(numbers: list[Any], o: Any, d: Any, light: Any, distance: Any) -> Any:
    """Say whether `o` and the light lie strictly on two sides of the plane."""
    px, py, pz, nx, ny, nz = numbers
    point, n = mi.Vector3d(px, py, pz), mi.Vector3d(nx, ny, nz)
    side, other = dr.dot(o - point, n), dr.dot(light - point, n)
    return ((side < 0) & (other > 0)) | ((side > 0) & (other < 0))
