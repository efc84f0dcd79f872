"""What the lanes refuse, and what they declare."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from crosstrace.translators.errors import UnsupportedSceneError
from crosstrace.translators.mitsuba.fidelity import DEEPEST
from crosstrace.translators.registry import renderer
from crosstrace.translators.renderer import RenderOptions
from crosstrace.translators.scene import Scene, plane, sphere

Build = Callable[..., Scene]

GLASS = sphere([200, 50, 50], [0, 0, 0], 1, ka=0.2, kr=0.3, kt=0.5, n=1.4)
FLOOR = plane([100, 100, 200], [0, 0, -1], [0.1, 0, 2], ka=0.2, kd=0.6)
LIGHTS = [([200, 200, 200], [3, -4, 5])]
LANES = ("mitsuba", "mitsuba-f64")


def many(count: int) -> Scene:
    """Return a scene of equal spheres."""
    geometry = np.zeros((count, 6))
    geometry[:, 3] = 1.0
    return Scene(
        delivery=1, v_res=2, h_res=2, pixel_size=1.0, screen_distance=1.0, eye=np.zeros(3),
        target=np.ones(3), up=np.array([0.0, 0, 1]), background=np.zeros(3),
        kind=np.zeros(count, np.uint8), color=np.zeros((count, 3)), geometry=geometry,
        material=np.tile([1.0, 0, 0, 1, 0, 0, 1], (count, 1)),
    )  # fmt: skip


@pytest.mark.parametrize("lane", LANES)
def test_too_many_objects_are_refused_at_once(lane: str) -> None:
    """A million objects are refused before Mitsuba is even imported, with the limit said."""
    limit = renderer(lane).capabilities.max_objects
    with pytest.raises(UnsupportedSceneError, match=f"at most {limit} objects, found 1000000"):
        renderer(lane).render(many(10**6), RenderOptions())


def test_the_exact_lane_declares_that_it_cannot_take_many_objects() -> None:
    """What it refuses stands in its ledger, with the reason."""
    limit = renderer("mitsuba-f64").capabilities.max_objects
    assert limit is not None
    declared = {n: renderer("mitsuba-f64").ledger(many(n)).entries for n in (limit, limit + 1)}
    assert [entry.fidelity for entry in declared[limit]] == ["approximated"]
    assert [entry.fidelity for entry in declared[limit + 1]] == ["approximated", "unsupported"]
    assert "every ray asks all" in declared[limit + 1][1].situation


@pytest.mark.parametrize("lane", LANES)
def test_too_many_pixels_are_refused(lane: str, make_scene: Build) -> None:
    """The image must fit memory."""
    with pytest.raises(UnsupportedSceneError, match="pixels"):
        renderer(lane).render(make_scene(v_res=100_000, h_res=100_000), RenderOptions())


@pytest.mark.parametrize("lane", LANES)
def test_depth_is_limited_only_where_rays_branch(lane: str, make_scene: Build) -> None:
    """Where an object has both kr and kt, waiting rays need room; elsewhere depth is free."""
    deep = DEEPEST + 1
    branching = make_scene(objects=[GLASS], max_depth=deep)
    with pytest.raises(UnsupportedSceneError, match=f"max_depth of at most {DEEPEST}"):
        renderer(lane).translate(branching, RenderOptions())
    mirror_and_window = [
        sphere([0, 0, 0], [0, 0, 0], 1, kr=0.5), sphere([0, 0, 0], [3, 0, 0], 1, kt=0.5, n=1.5)
    ]  # fmt: skip
    renderer(lane).translate(make_scene(objects=mirror_and_window, max_depth=deep), RenderOptions())


@pytest.mark.parametrize("things", [
    {"objects": [sphere([0, 0, 0], [0, 0, 1e30], 1e29)]},
    {"objects": [sphere([0, 0, 0], [0, 0, 0], 1e-30)]},
    {"lights": [([9, 9, 9], [0, 1e30, 0])]},
])  # fmt: skip
def test_magnitudes_beyond_float32_are_refused(things: dict[str, Any], make_scene: Build) -> None:
    """Their squares would overflow or vanish in Mitsuba's own geometry, but not in Float64."""
    scene = make_scene(**things)
    with pytest.raises(UnsupportedSceneError, match="magnitudes"):
        renderer("mitsuba").translate(scene, RenderOptions())
    assert renderer("mitsuba-f64").translate(scene, RenderOptions()).files


def test_the_recursions_stack_is_as_deep_as_declared(works: None) -> None:
    """The limit that is checked without Mitsuba is the kernel's own."""
    from crosstrace.translators.mitsuba.recursion import STACK

    assert STACK == DEEPEST


def test_the_exact_lane_declares_rounding_only(make_scene: Build) -> None:
    """Nothing else is approximated."""
    entries = renderer("mitsuba-f64").ledger(make_scene(objects=[GLASS, FLOOR], lights=LIGHTS))
    assert [entry.effect for entry in entries] == ["arithmetic"]


def test_the_float32_lane_declares_mitsubas_rules(make_scene: Build) -> None:
    """Rounding, near plane, offsets of every kind of ray, and the planes that end."""
    scene = make_scene(objects=[GLASS, FLOOR], lights=LIGHTS, max_depth=3)
    entries = renderer("mitsuba").ledger(scene)
    declared = {entry.effect for entry in entries}
    assert declared >= {"arithmetic", "geometry", "camera", "shadows", "reflection", "refraction"}
    assert any("offset=mitsuba" in e.situation for e in entries if e.effect == "shadows")
    assert [entry.objects for entry in entries if "planes end" in entry.situation] == [(1,)]


def test_huge_spheres_are_declared(make_scene: Build) -> None:
    """Float32 loses the shadows of a sphere of radius 1e5."""
    ground = sphere([9, 9, 9], [0, 0, -1e5], 1e5, ka=1)
    entries = renderer("mitsuba").ledger(make_scene(objects=[FLOOR, ground]))
    assert (1,) in [entry.objects for entry in entries]


def test_a_flat_scene_declares_no_shadows(make_scene: Build) -> None:
    """The ledger speaks of this scene, not of all that could be."""
    ball = sphere([9, 9, 9], [0, 0, 0], 1)
    declared = {
        e.effect for e in renderer("mitsuba").ledger(make_scene(delivery=1, objects=[ball]))
    }
    assert declared == {"arithmetic", "geometry", "camera"}
