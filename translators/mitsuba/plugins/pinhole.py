"""`crosstrace_pinhole`: the course's camera (2.3) from float64 numbers.

| parameter | type | meaning |
|---|---|---|
| `eye`, `target`, `up` | point | E, L and up, world units |
| `pixel_size`, `screen_distance` | float | s and d, world units |
| `near` | float | float32 rays start this far in front of E, along the view (1e-2) |

The directions are worked out in Float64 through the centres of the film's pixels. Mitsuba's rays
are float32: they are rounded once. `directions` gives them unrounded.
"""

# mypy: disallow-subclassing-any=False
# (Mitsuba makes its classes per variant at run time: a type checker cannot know them.)

from __future__ import annotations

import math
from typing import Any

import drjit as dr
import mitsuba as mi
import numpy as np

from crosstrace.translators.mitsuba.camera import basis


class Pinhole(mi.Sensor):
    """The camera; see the table above."""

    def __init__(self, props: Any) -> None:
        """Read the parameters and work out the basis, in float64."""
        super().__init__(props)
        self.eye = np.array(props["eye"], np.float64)
        target, up = (np.array(props[name], np.float64) for name in ("target", "up"))
        self._basis = [
            dr.opaque(mi.Vector3d, axis.tolist()) for axis in basis(self.eye, target, up)
        ]
        size, distance = float(props["pixel_size"]), float(props["screen_distance"])
        # Directions do not depend on the scale: a power of two takes it away without rounding.
        scale = 2.0 ** -math.frexp(max(abs(size), abs(distance)))[1]
        self._size = dr.opaque(mi.Float64, size * scale)
        self._distance = dr.opaque(mi.Float64, distance * scale)
        self._eye = dr.opaque(mi.Vector3d, self.eye.tolist())
        self._near = dr.opaque(mi.Float64, float(props.get("near", 1e-2)))
        width, height = self.film().size()
        self._half_width = dr.opaque(mi.Float64, width / 2 - 0.5)
        self._half_height = dr.opaque(mi.Float64, height / 2 - 0.5)

    def directions(self, row: Any, column: Any) -> Any:
        """Return the unit direction through the centre of each pixel, Float64 (3, n)."""
        u, v, w = self._basis
        x = self._size * (mi.Float64(column) - self._half_width)
        y = self._size * (self._half_height - mi.Float64(row))
        return dr.normalize(x * u + y * v - self._distance * w)

    def sample_ray(
        self, time: Any, sample1: Any, sample2: Any, sample3: Any, active: Any = True
    ) -> tuple[Any, Any]:
        """Return the float32 ray through the centre of the pixel that holds `sample2`."""
        size = self.film().size()
        column, row = dr.floor(sample2.x * size.x), dr.floor(sample2.y * size.y)
        direction = self.directions(row, column)
        start = self._near / dr.dot(direction, -self._basis[2])
        ray = dr.zeros(mi.Ray3f)
        ray.o = mi.Point3f(self._eye + start * direction)
        ray.d = mi.Vector3f(direction)
        ray.maxt = dr.largest(mi.Float)
        ray.time = time
        return ray, mi.Color3f(1)

    def sample_ray_differential(
        self, time: Any, sample1: Any, sample2: Any, sample3: Any, active: Any = True
    ) -> tuple[Any, Any]:
        """Return the same ray, without differentials."""
        ray, weight = self.sample_ray(time, sample1, sample2, sample3, active)
        return mi.RayDifferential3f(ray), weight

    def bbox(self) -> Any:
        """Return the eye's place."""
        return mi.ScalarBoundingBox3f(mi.ScalarPoint3f(self.eye.tolist()))

    def to_string(self) -> str:
        """Describe the camera on one line."""
        return f"Pinhole[eye={self.eye.tolist()}]"
