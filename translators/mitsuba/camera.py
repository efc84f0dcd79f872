"""The course's camera in float64 on the host: its basis, and on which surfaces its eye lies.

Formulas: 2.3 of the specification.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

#: The eye lies on a surface when its residual is within this many units in the last place.
EYE_ULPS = 4 * 2.0**-52


def basis(eye: Array, target: Array, up: Array) -> tuple[Array, Array, Array]:
    """Return (u, v, w): right, up and backwards of the screen, each (3,) and of length 1."""
    w = unit(eye - target)
    u = unit(np.cross(unit(up), w))
    return u, np.cross(w, u), w


def unit(vector: Array) -> Array:
    """Return the vector at length 1; scaled first, so that no square overflows or vanishes."""
    scaled = vector / np.abs(vector).max()
    return np.asarray(scaled / math.sqrt(float(scaled @ scaled)))


def foot(eye: Array, point: Array, normal: Array) -> Array:
    """Return the foot of the perpendicular from the eye on a plane, (3,)."""
    n = unit(normal)
    return eye - float((eye - point) @ n) * n


def eye_on_sphere(eye: Array, center: Array, radius: Array) -> NDArray[np.bool_]:
    """Say on which spheres the eye lies: centres (k, 3), radii (k,) → (k,)."""
    f = np.asarray(eye, np.longdouble) - center
    residual = np.abs(np.sqrt((f * f).sum(axis=1)) - radius)
    magnitude = np.maximum(np.abs(center).max(axis=1, initial=0.0), np.abs(eye).max())
    return np.asarray(residual <= EYE_ULPS * np.maximum(magnitude, radius))


def eye_on_plane(eye: Array, point: Array, normal: Array) -> NDArray[np.bool_]:
    """Say on which planes the eye lies: points and normals (k, 3) → (k,)."""
    residual = np.abs(((np.asarray(eye, np.longdouble) - point) * normal).sum(axis=1))
    magnitude = (np.abs(normal) * (np.abs(eye) + np.abs(point))).sum(axis=1)
    return np.asarray(residual <= EYE_ULPS * magnitude)
