"""Under POV-Ray's declared habits the native tracer draws what POV-Ray draws."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from crosstrace.translators.ledger import Emulation
from crosstrace.translators.povray.adapter import PovRay
from crosstrace.translators.registry import renderer
from crosstrace.translators.renderer import RenderOptions
from crosstrace.translators.scene import Scene, plane, sphere

GLASS: dict[str, float] = {"ka": 0.05, "kd": 0.1, "ks": 0.3, "eta": 40, "kr": 0.1, "kt": 0.8}
FLOOR = plane([200, 200, 190], [0, 0, 0], [0, 0, 1], ka=0.2, kd=0.6, kr=0.1)
LIGHTS = [([220, 220, 220], [-4, -5, 6]), ([90, 90, 90], [5, -3, 4])]


def ball(center: list[float], radius: float, n: float) -> dict[str, Any]:
    return sphere([60, 90, 120], center, radius, n=n, **GLASS)


def native(scene: Scene, **readings: str) -> np.ndarray:
    return renderer("native").render(scene, RenderOptions(readings=readings)).image


def emulated(scene: Scene) -> np.ndarray:
    habits = renderer("povray").ledger(scene).emulation  # type: ignore[attr-defined]
    assert isinstance(habits, Emulation)
    return native(habits.scene, **habits.readings)


CROSSING = {
    "two balls": [ball([-0.3, 0, 0.9], 0.8, 1.5), ball([0.5, 0.1, 0.9], 0.7, 1.3)],
    "three balls": [ball([-0.4, 0, 0.9], 0.7, 1.5), ball([0.4, 0, 0.9], 0.7, 1.2),
                    ball([0, 0.3, 1.4], 0.6, 0.8)],
    "of one index": [ball([-0.3, 0, 0.9], 0.8, 1.4), ball([0.5, 0, 0.9], 0.8, 1.4)],
}  # fmt: skip


@pytest.mark.parametrize("depth", [0, 1, 2, 3, 6])
@pytest.mark.parametrize("objects", CROSSING.values(), ids=CROSSING)
def test_crossing_glass_is_drawn_by_the_list_of_interiors(
    povray: PovRay, make_scene: Callable[..., Scene], objects: list[dict[str, Any]], depth: int
) -> None:
    """No surface has POV-Ray's index there; with its habits all pixels come out but edges."""
    scene = make_scene(objects=[FLOOR, *objects], lights=LIGHTS, max_depth=depth)
    theirs = povray.render(scene, RenderOptions(threads=1, timeout_s=120))
    allowed = theirs.half_step + 2e-6
    off = (np.abs(theirs.image - emulated(scene)).max(axis=2) > allowed).sum()
    assert off <= 2
    plain = (np.abs(theirs.image - native(scene)).max(axis=2) > allowed).sum()
    # Glass that no ray leaves again within the depth bends nothing yet.
    assert plain > 100 or depth < 3


NESTED = {
    "a bubble in a ball": ([0.0, -4.0, 1.0], [ball([0, 0, 0.9], 0.8, 1.5),
                                              ball([0, 0, 0.9], 0.4, 0.7)]),
    "the eye in the ball": ([0.0, 0.0, 0.9], [ball([0, 0, 0.9], 0.8, 1.5)]),
    "the eye in two balls": ([0.0, 0.0, 0.9], [ball([0, 0, 0.9], 0.8, 1.5),
                                               ball([0, 0.1, 0.9], 0.4, 0.7),
                                               ball([0.5, 0.4, 0.9], 0.1, 1.2)]),
}  # fmt: skip


@pytest.mark.parametrize(("eye", "objects"), NESTED.values(), ids=NESTED)
def test_nested_glass_has_indices_that_mean_the_specification(
    make_scene: Callable[..., Scene], eye: list[float], objects: list[dict[str, Any]]
) -> None:
    """Absolute indices, seen from wherever the eye is, give the specification's picture."""
    scene = make_scene(eye=eye, target=[0.0, 4.0, 0.9], objects=[FLOOR, *objects], lights=LIGHTS)
    # Float32 indices bend by a few 1e-8; that moves an edge in a pixel or two.
    off = np.abs(emulated(scene) - native(scene)).max(axis=2) > 2e-6
    assert off.sum() <= 3


def test_interiors_and_tracked_media_are_one_where_nothing_crosses(
    make_scene: Callable[..., Scene],
) -> None:
    """What tells them apart is leaving an object that is not the innermost."""
    nested = make_scene(objects=[FLOOR, *NESTED["a bubble in a ball"][1]], lights=LIGHTS)
    same = native(nested, nesting="tracked") == native(nested, nesting="interiors")
    assert same.all()
    crossing = make_scene(objects=[FLOOR, *CROSSING["two balls"]], lights=LIGHTS)
    apart = native(crossing, nesting="tracked") != native(crossing, nesting="interiors")
    assert apart.any(axis=2).sum() > 20


def test_a_scene_is_emulated_without_being_changed(make_scene: Callable[..., Scene]) -> None:
    """The ledger's scene is a copy with other indices; the one asked about stays as it was."""
    scene = make_scene(objects=[FLOOR, *CROSSING["two balls"]], lights=LIGHTS)
    before = replace(scene)
    habits = renderer("povray").ledger(scene).emulation
    assert habits is not None and habits.scene != scene == before
