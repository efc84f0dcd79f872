"""Which effects a Scene calls for, object by object, so that a renderer is given only those.

The names are the steps of the specification: `flat` (delivery 1), the three terms of 3.2
(`ambient`, `diffuse`, `specular`), `shadows` (3.2), `reflection` and `refraction` (4.1, 4.2), and
`total_reflection` (the end of 4.2). An effect is called for where the scene's numbers let it change
a pixel: a specular term needs ks > 0 and a light that is not black, a reflection needs kr > 0 and a
depth that allows a secondary ray. Under the default readings it also counts what a ray of the view
can get to (`reach.py`): an object that none meets calls for nothing, though it may throw a shadow,
and one that is met only by the last ray that the depth allows calls for no other ray.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from crosstrace.translators import reach
from crosstrace.translators.readings import deviating
from crosstrace.translators.scene import (
    DEFAULT_MATERIAL,
    ETA,
    KA,
    KD,
    KR,
    KS,
    KT,
    Delivery,
    N,
    Scene,
)

#: In the order of the bits of a mask.
EFFECTS = (
    "flat", "ambient", "diffuse", "specular",
    "shadows", "reflection", "refraction", "total_reflection",
)  # fmt: skip

BIT = {name: 1 << i for i, name in enumerate(EFFECTS)}


@dataclass(frozen=True)
class SceneEffects:
    """Masks of `BIT`: `overall` for the scene, `objects` (n,) uint16 for each object."""

    overall: int
    objects: NDArray[np.uint16]

    @property
    def names(self) -> tuple[str, ...]:
        """The scene's effects by name."""
        return names(self.overall)


def names(mask: int) -> tuple[str, ...]:
    """Return the names in a mask, in the order of `EFFECTS`."""
    return tuple(name for name in EFFECTS if mask & BIT[name])


def of_delivery(delivery: int) -> frozenset[str]:
    """Return the effects that a delivery knows: what a renderer is given that leaves none out."""
    return frozenset({"flat"}) if delivery == 1 else frozenset(EFFECTS) - {"flat"}


def mask(effect_names: frozenset[str] | tuple[str, ...]) -> int:
    """Return the mask of some effect names; KeyError for an unknown one."""
    return sum(BIT[name] for name in set(effect_names))


def effects(scene: Scene, readings: Mapping[str, str] | None = None) -> SceneEffects:
    """Work out the effects of a scene, under readings of the specification where any are given."""
    n = len(scene)
    is_met, sends_on = _met(scene, not deviating(readings or {}))
    if scene.delivery == 1:
        flat = np.where(is_met, np.uint16(BIT["flat"]), np.uint16(0))
        return SceneEffects(int(np.bitwise_or.reduce(flat, initial=0)), flat)
    material, color = scene.material, scene.color
    light = scene.lights[:, :3].max(axis=0, initial=0.0)
    readings = readings or {}
    depth = scene.max_depth + _DEPTH_SHIFT.get(readings.get("depth", ""), 0)
    tir = readings.get("tir", "")

    ambient = (material[:, KA] > 0) & ((color > 0) & (scene.ambient > 0)).any(axis=1)
    diffuse = (material[:, KD] > 0) & ((color > 0) & (light > 0)).any(axis=1)
    specular = (material[:, KS] > 0) & bool((light > 0).any())
    # These readings show the coefficients of secondary rays even where none is sent.
    shown = readings.get("exhausted") == "background" or readings.get("mix") == "convex"
    secondary = depth > 0 or shown
    bends = material[:, N] != 1.0
    transparent = material[:, KT] > 0
    totally = {"ignore": np.zeros(n, bool), "always": bends}.get(tir, transparent & bends)
    called_for = {
        "ambient": ambient,
        "diffuse": diffuse,
        "specular": specular,
        "shadows": diffuse | specular,
        "reflection": (material[:, KR] > 0) & secondary,
        "refraction": transparent & secondary,
        "total_reflection": totally & secondary,
    }
    objects = np.zeros(n, np.uint16)
    for name, where in called_for.items():
        after = name in ("reflection", "refraction", "total_reflection")
        objects[where & (sends_on if after else is_met)] |= BIT[name]
    return SceneEffects(int(np.bitwise_or.reduce(objects, initial=0)), objects)


def needed(scene: Scene, called_for: SceneEffects) -> Scene:
    """Return a scene of the same image with nothing in it that no called-for effect reads.

    Coefficients of effects that are not called for are 0, eta and n then 1, unread colours black;
    lights without colour are gone.
    """
    if scene.delivery == 1:
        return scene
    material, color = scene.material.copy(), scene.color.copy()
    by_effect = {"ambient": KA, "diffuse": KD, "specular": KS, "reflection": KR, "refraction": KT}
    off = {name: (called_for.objects & np.uint16(BIT[name])) == 0 for name in EFFECTS}
    for name, column in by_effect.items():
        material[off[name], column] = 0.0
    unread = DEFAULT_MATERIAL[3]
    material[off["specular"], ETA] = unread[ETA]
    material[off["refraction"] & off["total_reflection"], N] = unread[N]
    color[off["ambient"] & off["diffuse"]] = 0.0
    lights = scene.lights[(scene.lights[:, :3] > 0).any(axis=1)]
    return replace(scene, material=material, color=color, lights=lights)


def _met(scene: Scene, sharply: bool) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Say which objects a ray may meet, and which while the depth still allows another ray."""
    n = len(scene)
    if not sharply or n == 0:
        return np.ones(n, bool), np.ones(n, bool)
    sends = (scene.material[:, KR] > 0) | (scene.material[:, KT] > 0)
    bounces = reach.bounces(scene, sends & (scene.delivery == Delivery.WHITTED))
    met: NDArray[np.bool_] = bounces < reach.NEVER
    return met, bounces < scene.max_depth


_DEPTH_SHIFT = {"minus-one": -1, "plus-one": 1}
