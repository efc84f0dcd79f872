"""The ray tree of one pixel: every ray of the native tracer, in double, with what it decided.

The recorder (`native/src/kernel_explain.c`) is the tracer's own text with hooks, so hash and colour
of the tree equal a rendering's to the last bit, under every reading.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import IntEnum
from typing import Any

from crosstrace.native import _core
from crosstrace.translators import readings as readings_of_the_specification
from crosstrace.translators.effects import effects
from crosstrace.translators.errors import RendererError, UsageError
from crosstrace.translators.native.truth import Decision
from crosstrace.translators.renderer import Progress
from crosstrace.translators.scene import Scene

#: Rays of a tree that are kept, in the order of tracing; the others are counted.
MAX_RAYS = 100_000

#: Enough for nearly every pixel, so that few trees are traced twice.
_FIRST_ROOM = 512

Vector = tuple[float, float, float]


class RayKind(IntEnum):
    """How a ray came about."""

    PRIMARY = 0
    SHADOW = 1
    REFLECTED = 2
    REFRACTED = 3
    TOTALLY_REFLECTED = 4


@dataclass(frozen=True)
class Ray:
    """One ray of a tree; lengths are world units, colours linear, what is not there is −1, 0 or ∞.

    `parent` is the index of the ray whose hit it leaves. `object` is what it hits, or the first
    object in the file that blocks a shadow ray, at `t_world` and `point`. `weight` is the product
    of kr and kt down to the ray. `color` is what it returns: its local terms `base`, `diffuse`,
    `specular` and `unsent` (rays not sent for want of depth, where a reading lets them count), and
    what its secondary rays return. A shadow ray's terms are what its light adds if nothing blocks
    it. `margin` is the relative change that would turn the nearest decision of the ray or its hit,
    which `margin_decision` and `margin_object` name; `clearance` the relative distance of its start
    from the surface that it leaves. `ct_ray_record` in `native/include/crosstrace.h` defines all of
    it precisely.
    """

    kind: RayKind
    parent: int
    depth: int
    object: int
    light: int
    margin_decision: Decision
    margin_object: int
    inside: bool
    total: bool
    weight: float
    t_world: float
    light_distance: float
    margin: float
    origin: Vector
    direction: Vector
    point: Vector
    normal: Vector
    color: Vector
    base: Vector
    diffuse: Vector
    specular: Vector
    unsent: Vector
    clearance: float

    @property
    def contribution(self) -> Vector:
        """What the ray's local terms add to the pixel; of a shadow ray, which they already hold."""
        terms = zip(self.base, self.diffuse, self.specular, self.unsent, strict=True)
        red, green, blue = (self.weight * sum(channel) for channel in terms)
        return red, green, blue


@dataclass(frozen=True)
class PixelTree:
    """The rays of a pixel, depth first; `rays` lacks those beyond `MAX_RAYS` of the `n_rays`.

    The contributions of all rays but shadow rays add up to `color`, except under a reading that
    limits returned colours. `tree` is the hash that a rendering's layer of that name holds.
    """

    row: int
    column: int
    rays: list[Ray]
    n_rays: int
    tree: int
    color: Vector


def explain(
    scene: Scene,
    row: int,
    column: int,
    readings: Mapping[str, str] | None = None,
    *,
    max_rays: int = MAX_RAYS,
    progress: Progress | None = None,
) -> PixelTree:
    """Record the ray tree of the pixel in `row` and `column`, both from 0, row 0 at the top.

    Raises UsageError for a pixel outside the image or a reading that does not exist, RendererError
    where the ray budget is used up.
    """
    check_pixel(scene, row, column)
    readings = dict(readings or {})
    readings_of_the_specification.check(readings)
    settings = [*readings.items(), ("effects", str(effects(scene, readings).overall))]
    view = scene.native_view()
    room = min(_FIRST_ROOM, max_rays)
    try:
        found = _core.explain(view, settings, row, column, room, progress)
        if found[1] > room < max_rays:
            room = min(found[1], max_rays)
            found = _core.explain(view, settings, row, column, room, progress)
    except RuntimeError as error:
        raise RendererError(f"native: {error}") from None
    rays, n_rays, tree, color = found
    return PixelTree(row, column, [_ray(ray) for ray in rays], n_rays, tree, color)


def check_pixel(scene: Scene, row: int, column: int) -> None:
    """Raise UsageError for a pixel outside the scene's image."""
    for what, value, size in (("row", row, scene.v_res), ("column", column, scene.h_res)):
        if not 0 <= value < size:
            raise UsageError(f"{what}: expected 0 to {size - 1}, found {value}")


def _ray(parts: tuple[Any, ...]) -> Ray:
    kind, parent, depth, object_, light, decision, margin_object, inside, total, *rest = parts
    return Ray(RayKind(kind), parent, depth, object_, light, Decision(decision), margin_object,
               bool(inside), bool(total), *rest)  # fmt: skip
