"""Scene edits: a lane is given a scene that is a little off.

Each returns a new Scene, or None where the scene has nothing to edit.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crosstrace.harness.lanes import REFERENCE, loaded
from crosstrace.translators.renderer import RenderOptions
from crosstrace.translators.scene import ETA, KD, KS, KT, Delivery, N, Scene

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

#: Rows of the small image in which objects are looked for.
_LOOK_ROWS = 120

#: Objects that cover less of that image are passed over where another covers more.
_LEAST_SHARE = 0.01

LIGHT_STEP = 1e-2
_MOVED_BY = np.array([0.6, 0.64, 0.48]) * LIGHT_STEP


def _edited(scene: Scene, **fields: Any) -> Scene:
    return replace(scene, checked=False, **fields)


def seen_object(scene: Scene) -> int | None:
    """Return the object to lose: of those seen in 1 % of the picture, the one seen least.

    Where none is seen that often, the one seen most; None where none is seen at all. A large object
    that is missing is no test, an object out of sight is no fault. Counted in the native tracer's
    image of 120 rows; equal counts go to the object first in the file.
    """
    columns = max(1, round(_LOOK_ROWS * scene.h_res / scene.v_res))
    small = scene.resized(_LOOK_ROWS, columns)
    seen = loaded(REFERENCE).render(small, RenderOptions(threads=1, layers=True)).layers["object"]
    counts = np.bincount(seen[seen >= 0], minlength=len(scene))
    if not counts.any():
        return None
    often = counts >= _LEAST_SHARE * seen.size
    chosen = np.where(often, counts, seen.size + 1).argmin() if often.any() else counts.argmax()
    return int(chosen)


def without_an_object(scene: Scene) -> Scene | None:
    """Leave out the object of `seen_object`."""
    lost = seen_object(scene)
    if lost is None:
        return None
    kept = np.arange(len(scene)) != lost
    return _edited(
        scene, kind=scene.kind[kept], color=scene.color[kept],
        material=scene.material[kept], geometry=scene.geometry[kept],
    )  # fmt: skip


def without_a_light(scene: Scene) -> Scene | None:
    """Leave out the first light that is not black."""
    lost = _first_light(scene)
    return None if lost is None else _edited(scene, lights=np.delete(scene.lights, lost, axis=0))


def light_moved(scene: Scene) -> Scene | None:
    """Move the first light that is not black by 1e-2 world units, along no axis."""
    moved = _first_light(scene)
    if moved is None:
        return None
    lights = scene.lights.copy()
    lights[moved, 3:] += _MOVED_BY
    return _edited(scene, lights=lights)


def _first_light(scene: Scene) -> int | None:
    shining = np.flatnonzero(scene.lights[:, :3].any(axis=1))
    return int(shining[0]) if len(shining) else None


def one_bounce_fewer(scene: Scene) -> Scene | None:
    """Take one from max_depth."""
    return _edited(scene, max_depth=scene.max_depth - 1) if scene.max_depth else None


def one_bounce_more(scene: Scene) -> Scene | None:
    """Add one to max_depth; before the third delivery nothing bounces."""
    if scene.delivery != Delivery.WHITTED:
        return None
    return _edited(scene, max_depth=scene.max_depth + 1)


def planes_turned(scene: Scene) -> Scene | None:
    """Negate the normal of every plane; a sphere has none to negate."""
    geometry = scene.geometry.copy()
    geometry[~scene.is_sphere, 3:] *= -1.0
    return None if scene.is_sphere.all() else _edited(scene, geometry=geometry)


def indices_inverted(scene: Scene) -> Scene | None:
    """Take 1/n for every transparent object's n."""
    return _material(scene, N, 1 / scene.material[:, N], scene.material[:, KT] > 0)


def indices_off(scene: Scene) -> Scene | None:
    """Multiply every transparent object's n by 1.001."""
    return _material(scene, N, 1.001 * scene.material[:, N], scene.material[:, KT] > 0)


def diffuse_off(scene: Scene) -> Scene | None:
    """Multiply every kd by 1.002, divide those that would pass 1."""
    kd = scene.material[:, KD]
    return _material(scene, KD, np.where(1.002 * kd <= 1, 1.002 * kd, kd / 1.002), kd > 0)


def exponents_off(scene: Scene) -> Scene | None:
    """Add 1 to the exponent of every highlight."""
    return _material(scene, ETA, scene.material[:, ETA] + 1, scene.material[:, KS] > 0)


def _material(scene: Scene, column: int, values: Array, where: Mask) -> Scene | None:
    material = scene.material.copy()
    material[where, column] = values[where]
    return _edited(scene, material=material) if where.any() else None


def radii_off(scene: Scene) -> Scene | None:
    """Multiply every radius by 1.001."""
    geometry = scene.geometry.copy()
    geometry[scene.is_sphere, 3] *= 1.001
    return _edited(scene, geometry=geometry) if scene.is_sphere.any() else None


def quarter_turn(scene: Scene) -> Scene:
    """Take u of the camera for its up: v becomes what u was, and u what −v was.

    A rotation is all that an up vector can do; to trade both axes would also mirror the picture.
    """
    w = scene.eye - scene.target
    u = np.cross(scene.up, w)
    return _edited(scene, up=u / np.linalg.norm(u))


def half_pixel_turn(scene: Scene) -> Scene:
    """Aim the camera half a pixel to the left, so that the picture's centre moves to the right."""
    view = scene.target - scene.eye
    u = np.cross(view, scene.up)
    half = 0.5 * scene.pixel_size / scene.screen_distance
    aside = u / np.linalg.norm(u) * np.linalg.norm(view) * half
    return _edited(scene, target=scene.target - aside)
