"""Bounded pruning: rays are left out, and no pixel gets darker by more than the tolerance."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from importlib.resources import files
from pathlib import Path

import numpy as np
import pytest

from crosstrace.translators.course import load, parse
from crosstrace.translators.errors import UnsupportedSceneError, UsageError
from crosstrace.translators.native.adapter import present
from crosstrace.translators.registry import renderer
from crosstrace.translators.renderer import RenderOptions
from crosstrace.translators.scene import Scene

Generator = Callable[..., Scene]
TOLERANCES = (1e-12, 1e-6, 1e-4, 1e-3, 1 / 255, 0.05, 0.3, 2.0)
COURSE = sorted(
    Path(str(path))
    for path in files("crosstrace.scenes").joinpath("course").iterdir()
    if path.name.endswith(".txt")
)


def _render(
    scene: Scene, tolerance: float, precision: str = "f64", readings: dict[str, str] | None = None
) -> tuple[np.ndarray, int]:
    """Return the image and the number of rays."""
    options = RenderOptions(
        precision=precision, readings=readings or {}, layers=True, tolerance=tolerance
    )
    made = renderer("native").render(scene, options)
    return made.image, int(made.layers["rays"].sum())


def _rays_left(
    scene: Scene, precision: str = "f64", readings: dict[str, str] | None = None
) -> list[int]:
    """Check the bound at every tolerance; return the rays traced at each, first without one."""
    full, n_rays = _render(scene, 0.0, precision, readings)
    left = [n_rays]
    for tolerance in TOLERANCES:
        image, n_rays = _render(scene, tolerance, precision, readings)
        darker = full - image
        # Nothing gets brighter, as light is never negative and rounding is monotonous.
        assert darker.min() >= 0
        assert darker.max() <= tolerance
        left.append(n_rays)
    return left


@pytest.mark.parametrize("path", COURSE, ids=lambda path: path.stem)
def test_course_scenes_lose_no_more_than_the_tolerance(path: Path) -> None:
    """At any tolerance every channel of every pixel is within it, and no ray is added."""
    left = _rays_left(load(path).resized(45, 61))
    assert max(left) == left[0]


@pytest.mark.parametrize("precision", ["f32", "f64", "f128"])
@pytest.mark.parametrize("seed", range(20))
def test_random_scenes_lose_no_more_than_the_tolerance(
    random_scene: Generator, seed: int, precision: str
) -> None:
    """Mirrors, glass, total reflection, eyes inside glass, in narrow and wide types."""
    if precision not in present():
        pytest.skip(f"no {precision} on this platform")
    scene = random_scene(seed, 3, 6)
    _rays_left(scene.resized(12, 16) if precision == "f128" else scene, precision)


@pytest.mark.parametrize(
    "readings",
    [
        {"exhausted": "background"}, {"miss": "black"}, {"tir": "add"}, {"tir": "plus-one"},
        {"tir": "always"}, {"tir": "needs-kr"}, {"recursion": "clamp"}, {"recursion": "scale"},
        {"mix": "convex"}, {"nesting": "interiors"}, {"nesting": "tracked"},
        {"plane_normal": "raw"}, {"lighting_normal": "facing", "view": "eye"},
        {"depth": "plus-one", "offset": "normal"},
    ],
    ids=lambda readings: "-".join(readings.values()),
)  # fmt: skip
def test_the_bound_holds_under_every_reading(
    random_scene: Generator, readings: dict[str, str]
) -> None:
    """Where a reading makes light negative or scales it, nothing is left out instead."""
    for seed in (3, 7, 11, 16):
        _rays_left(random_scene(seed, 3, 4), readings=readings)


def test_rays_are_saved_where_weak_branches_are_many() -> None:
    """Among glass of little reflection half the rays carry less than a hundredth of white."""
    ball = "90 90 90 .1 .3 0 20 .05 .7 1.3"
    scene = parse(
        "24 32 0.05 1 0 -6 0.5 0 0 0.4 0 0 1 120 170 230 8 4 200 200 200 .2 .6 0 1 .1 0 1 / "
        f"0 0 -1 0 0 1 {ball} * -1 0 0.3 .8 {ball} * 1 0 0.3 .8 {ball} * 0 1 0.5 .9 "
        "255 255 255 1 150 150 150 -4 -5 6"
    )
    left = dict(zip((0.0, *TOLERANCES), _rays_left(scene), strict=True))
    assert left[0.0] > left[1e-4] > left[1 / 255] > left[0.3]
    assert left[0.05] < left[0.0] / 2
    # The tolerance is for the pixel as a whole, and a good part of it is used.
    full, pruned = _render(scene, 0.0)[0], _render(scene, 0.3)[0]
    assert (full - pruned).max() > 0.03


def test_every_light_is_counted(random_scene: Generator) -> None:
    """With fifty times the lights, branches count for as much more."""
    scene = random_scene(7, 3, 6)
    _rays_left(replace(scene, lights=np.tile(scene.lights, (50, 1)), checked=False))


def test_tolerance_zero_leaves_every_bit(random_scene: Generator) -> None:
    """A tolerance of 0, and one below rounding, trace every ray."""
    for seed in range(4):
        scene = random_scene(seed, 3, 5)
        full, n_rays = _render(scene, 0.0)
        least, n_least = _render(scene, 1e-17)
        assert np.array_equal(full, least)
        assert n_rays == n_least


@pytest.mark.parametrize("tolerance", [-1.0, float("nan"), float("inf")])
def test_what_is_no_tolerance_is_refused(random_scene: Generator, tolerance: float) -> None:
    """A negative one, infinity and what is no number are wrong usage."""
    with pytest.raises(UsageError, match="tolerance: expected"):
        _render(random_scene(0), tolerance)


@pytest.mark.parametrize("lane", ["mitsuba", "mitsuba-f64", "povray"])
def test_other_renderers_refuse_a_tolerance(random_scene: Generator, lane: str) -> None:
    """They trace every ray, and say so rather than ignore what was asked."""
    with pytest.raises(UnsupportedSceneError, match="traces every ray"):
        renderer(lane).render(random_scene(0), RenderOptions(tolerance=0.1))


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(100, 400))
def test_many_random_scenes_lose_no_more_than_the_tolerance(
    random_scene: Generator, seed: int
) -> None:
    """As above, for more scenes."""
    _rays_left(random_scene(seed, 3, 6), ("f64", "f32")[seed % 2])
