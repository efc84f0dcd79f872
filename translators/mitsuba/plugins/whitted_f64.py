"""`crosstrace_whitted_f64`: the specification's recursion with every computation in Float64.

Takes the parameters of `crosstrace_whitted`, and the objects as nested `crosstrace_phong` BSDFs
that hold their surface, in the order of their ids (`object_0`, `object_1`, …): Mitsuba's own
shapes are float32. It needs a `crosstrace_pinhole`, and `crosstrace_point` lights with ids in the
same manner.

`image64` holds the last image as float64, (height, width, 3); `render` returns it as float32.
"""

# mypy: disallow-subclassing-any=False
# (Mitsuba makes its classes per variant at run time: a type checker cannot know them.)

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any

import drjit as dr
import mitsuba as mi
import numpy as np

from crosstrace.translators.effects import EFFECTS
from crosstrace.translators.mitsuba.exact_surfaces import Surfaces
from crosstrace.translators.mitsuba.exact_world import ExactWorld, Lighting, Materials
from crosstrace.translators.mitsuba.plugins.phong import Phong
from crosstrace.translators.mitsuba.plugins.point import Point
from crosstrace.translators.mitsuba.recursion import radiance

#: Ray-surface tests, roughly, in one kernel launch: about half a second on two cores, so that
#: progress is seen, and memory stays bounded, while small images still take a single launch.
BAND_TESTS = 5e7


class WhittedF64(mi.SamplingIntegrator):
    """The integrator; see above."""

    def __init__(self, props: Any) -> None:
        """Read the parameters and the objects."""
        super().__init__(props)
        self._ambient = np.array(props["ambient"], np.float64)
        self._background = np.array(props["background"], np.float64)
        self._max_depth = int(props.get("max_depth", 0))
        self._effects = frozenset(props.get("effects", " ".join(EFFECTS)).split())
        self._branches = bool(props.get("branches", True))
        children = (child for _, child in props.objects())
        self._objects = _by_id(child for child in children if isinstance(child, Phong))
        self.image64: Any = None
        self.progress: Callable[[float], None] | None = None

    def render(
        self, scene: Any, sensor: Any = 0, seed: Any = 0, spp: int = 0,
        develop: bool = True, evaluate: bool = True,
    ) -> Any:  # fmt: skip
        """Render in bands of rows; returns float32, see `image64`."""
        sensor = scene.sensors()[sensor] if isinstance(sensor, int) else sensor
        width, height = sensor.film().size()
        lights = _by_id(light for light in scene.emitters() if isinstance(light, Point))
        world = self._world(sensor, lights)
        tests = (1 + len(self._objects)) * (1 + len(lights))
        rows = int(min(height, max(1, BAND_TESTS / (tests * width))))
        image = np.empty((height, width, 3))
        for top in range(0, height, rows):
            count = min(rows, height - top)
            band = self._band(world, sensor, top, count, width)
            image[top : top + count] = np.array(band).T.reshape(count, width, 3)
            if self.progress is not None:
                self.progress((top + count) / height)
        self.image64 = image
        return mi.TensorXf(image.astype(np.float32))

    def _band(self, world: ExactWorld, sensor: Any, top: int, rows: int, width: int) -> Any:
        pixel = dr.arange(mi.UInt32, rows * width)
        across = dr.opaque(mi.UInt32, width)
        row = pixel // across
        direction = sensor.directions(row + dr.opaque(mi.UInt32, top), pixel - row * across)
        eye = dr.opaque(mi.Vector3d, sensor.eye.tolist())
        origin = eye + dr.zeros(mi.Vector3d, rows * width)
        spawning = {"reflection", "refraction", "total_reflection"} & self._effects
        return radiance(
            world.kinds, world.trace, (origin, direction), mi.Bool(True),
            max_depth=dr.opaque(mi.UInt32, self._max_depth),
            bounces=bool(spawning) and self._max_depth > 0, branches=self._branches,
        )  # fmt: skip

    def _world(self, sensor: Any, lights: list[Any]) -> ExactWorld:
        count = len(self._objects)
        geometry = np.array([thing.geometry for thing in self._objects]).reshape(count, 6)
        is_sphere = np.array([thing.surface == "sphere" for thing in self._objects], bool)
        color = np.array([thing.color for thing in self._objects]).reshape(count, 3)
        coefficients = np.array([thing.coefficients for thing in self._objects])
        light_color = np.array([light.color for light in lights]).reshape(-1, 3)
        positions = np.array([light.position for light in lights]).reshape(-1, 3)
        return ExactWorld(
            Surfaces(is_sphere, geometry, sensor.eye),
            Materials(color / 255, coefficients.reshape(count, 7)),
            Lighting(self._ambient / 255, self._background / 255, light_color / 255, positions),
            self._effects,
        )

    def aov_names(self) -> list[str]:
        """Return no names: colour is the only output."""
        return []

    def to_string(self) -> str:
        """Describe the integrator on one line."""
        return f"WhittedF64[max_depth={self._max_depth}, effects={sorted(self._effects)}]"


def _by_id(things: Iterable[Any]) -> list[Any]:
    """Sort by the number at the end of the ids: Mitsuba may load them in any order."""
    return sorted(things, key=lambda thing: int(thing.id().rpartition("_")[2]))
