"""`crosstrace_point`: a point light that shines on everything alike, whatever the distance (3.1).

| parameter | type | meaning |
|---|---|---|
| `color` | point | c_j, each component in 0…255 |
| `position` | point | L_j, world units |

Mitsuba's own `point` falls off with the square of the distance, which the specification does not.
"""

# mypy: disallow-subclassing-any=False
# (Mitsuba makes its classes per variant at run time: a type checker cannot know them.)

from __future__ import annotations

from typing import Any

import drjit as dr
import mitsuba as mi
import numpy as np


class Point(mi.Emitter):
    """The light; see the table above."""

    def __init__(self, props: Any) -> None:
        """Read the parameters, in float64."""
        super().__init__(props)
        self.color = np.array(props["color"], np.float64)
        self.position = np.array(props["position"], np.float64)
        self._color = dr.opaque(mi.Color3f, (self.color / 255).tolist())
        self._position = dr.opaque(mi.Point3f, self.position.tolist())
        self.m_flags = +mi.EmitterFlags.DeltaPosition

    def sample_direction(self, it: Any, sample: Any, active: Any = True) -> tuple[Any, Any]:
        """Return the direction from `it` to the light, and the light's colour."""
        apart = self._position - it.p
        ds = dr.zeros(mi.DirectionSample3f)
        ds.p, ds.pdf, ds.delta = self._position, 1, True
        ds.dist = dr.norm(apart)
        ds.d = apart / ds.dist
        ds.n = -ds.d
        ds.emitter = mi.EmitterPtr(self)
        return ds, dr.select(active, self._color, 0)

    def pdf_direction(self, it: Any, ds: Any, active: Any = True) -> Any:
        """Return 0: no ray meets a point by chance."""
        return mi.Float(0)

    def eval(self, si: Any, active: Any = True) -> Any:
        """Return 0: the light itself cannot be seen."""
        return mi.Color3f(0)

    def bbox(self) -> Any:
        """Return the light's place."""
        return mi.ScalarBoundingBox3f(mi.ScalarPoint3f(self.position.tolist()))

    def to_string(self) -> str:
        """Describe the light on one line."""
        return f"Point[color={self.color.tolist()}, position={self.position.tolist()}]"
