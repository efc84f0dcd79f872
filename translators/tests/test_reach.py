"""What a ray of the view can get to: never too little, and less than all where that is plain."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from crosstrace.translators.course import parse
from crosstrace.translators.effects import EFFECTS, effects, needed, of_delivery
from crosstrace.translators.reach import NEVER, bounces, in_view
from crosstrace.translators.registry import renderer
from crosstrace.translators.renderer import RenderOptions
from crosstrace.translators.scene import Scene

Generator = Callable[..., Scene]
EVERYTHING = RenderOptions(effects=frozenset(EFFECTS))


def _narrow(scene: Scene, seed: int) -> Scene:
    """Look at the scene through a narrow picture, somewhere near its middle."""
    rng = np.random.default_rng(seed)
    target = scene.target + rng.uniform(-2.5, 2.5, 3)
    return replace(scene, pixel_size=scene.pixel_size / 4, target=target, checked=False)


@pytest.mark.parametrize("delivery", [1, 2, 3])
def test_what_is_seen_is_in_view(random_scene: Generator, delivery: int) -> None:
    """No first hit is on an object that was taken to be out of view; some are out of view."""
    left_out = 0
    for seed in range(60):
        scene = _narrow(random_scene(seed, delivery), seed)
        seen = renderer("native").render(scene, RenderOptions(layers=True)).layers["object"]
        view = in_view(scene)
        assert view[np.unique(seen[seen >= 0])].all()
        left_out += int((~view).sum())
    assert left_out > 60


@pytest.mark.parametrize("depth", [0, 1, 2, 5])
@pytest.mark.parametrize("seed", range(30))
def test_leaving_out_what_no_ray_gets_to_changes_no_bit(
    random_scene: Generator, seed: int, depth: int
) -> None:
    """The native image is that with all effects, and that of the scene with nothing unneeded."""
    scene = _narrow(random_scene(seed, 3, depth), seed)
    native = renderer("native")
    full = native.render(scene, EVERYTHING).image
    assert np.array_equal(native.render(scene, RenderOptions()).image, full)
    reduced = needed(scene, effects(scene))
    assert np.array_equal(native.render(reduced, EVERYTHING).image, full)


def test_something_is_left_out_of_narrow_views(random_scene: Generator) -> None:
    """Objects call for less where less is seen; else the test above would show nothing."""
    wide = [effects(random_scene(seed, 3, 1)) for seed in range(30)]
    narrow = [effects(_narrow(random_scene(seed, 3, 1), seed)) for seed in range(30)]
    less = [a.objects & ~b.objects for a, b in zip(wide, narrow, strict=True)]
    assert sum(int((it > 0).sum()) for it in less) > 20


CAMERA = "24 32 0.02 1 0 -6 1.5 0 0 0.8 0 0 1 120 170 230 "
FLOOR = "90 90 90 0.1 0.5 0 1 {floor} 1 / 0 0 0 0 0 1"


def _scene(depth: int, floor: str, ball: str, place: str) -> Scene:
    return parse(
        f"{CAMERA}{depth} 2 200 100 50 0 .3 0 1 {ball} 1.5 * {place} .5 "
        f"{FLOOR.format(floor=floor)} 255 255 255 1 200 200 200 -4 -5 6"
    )


@pytest.mark.parametrize(
    ("depth", "floor", "ball", "place", "expected"),
    [
        (3, "0 0", "0.5 0", "0 0 1", {"reflection"}),
        (3, "0 0", "0.5 0.2", "0 -9 1", set()),  # behind the eye
        (3, "0 0", "0.5 0.2", "0 0 -2", set()),  # below the floor
        (3, "0.1 0", "0.5 0.2", "0 -9 1", {"reflection", "refraction", "total_reflection"}),
        (1, "0.1 0", "0.5 0.2", "0 -9 1", {"reflection"}),  # met by the last rays only
    ],
)
def test_secondary_rays_are_called_for_where_rays_get_to(
    depth: int, floor: str, ball: str, place: str, expected: set[str]
) -> None:
    """A mirror or a glass that no ray meets while the depth allows another calls for none."""
    scene = _scene(depth, floor, ball, place)
    found = set(effects(scene).names) & {"reflection", "refraction", "total_reflection"}
    assert found == expected


def test_an_object_that_is_not_met_may_still_throw_a_shadow() -> None:
    """A ball behind the eye calls for nothing; the floor that it shades calls for shadows."""
    scene = _scene(0, "0 0", "0 0", "0 -9 1")
    assert effects(scene).objects[0] == 0
    assert "shadows" in effects(scene).names


def test_other_readings_are_taken_to_reach_everything() -> None:
    """What a reading does to rays is not followed: every object counts as met."""
    scene = _scene(3, "0 0", "0.5 0.2", "0 -9 1")
    assert "reflection" in effects(scene, {"nesting": "interiors"}).names
    assert "reflection" not in effects(scene, {"nesting": "relative"}).names


def test_a_mirror_in_view_leads_to_everything() -> None:
    """What one ray may meet a second one may meet, too."""
    scene = _scene(3, "0.1 0", "0 0", "0 -9 1")
    assert bounces(scene, np.array([False, True])).tolist() == [1, 0]
    assert bounces(scene, np.array([False, False])).tolist() == [NEVER, 0]


@pytest.mark.parametrize("lane", ["mitsuba", "mitsuba-f64", "povray"])
@pytest.mark.parametrize("seed", [2, 9, 13])
def test_no_renderer_misses_what_it_is_not_given(
    random_scene: Generator, lane: str, seed: int
) -> None:
    """Gated and ungated images have the same bits, in POV-Ray within its steps of output."""
    scene = _narrow(random_scene(seed, 3, 2), seed)
    translator = renderer(lane)
    if not translator.probe().available:
        pytest.skip(f"{lane} does not work here")
    gated = translator.render(scene, RenderOptions())
    full = translator.render(scene, RenderOptions(effects=of_delivery(3)))
    steps = gated.half_step + full.half_step
    assert np.abs(gated.image - full.image).max() <= steps


def test_unneeded_numbers_are_gone() -> None:
    """Coefficients that no effect reads are 0, exponents and indices 1, black lights gone."""
    scene = parse(
        f"{CAMERA}2 1 200 100 50 0.2 .3 0 77 0 0 1.7 * 0 0 1 1 "
        "90 90 90 2 0 0 0 1 1 1 200 200 200 -4 -5 6"
    )
    reduced = needed(scene, effects(scene))
    assert reduced.material.tolist() == [[0.2, 0.3, 0, 1, 0, 0, 1]]
    assert reduced.n_lights == 1


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(100, 700))
def test_many_narrow_views_lose_no_bit(random_scene: Generator, seed: int) -> None:
    """As above, for more scenes."""
    scene = _narrow(random_scene(seed, 3), seed)
    native = renderer("native")
    gated, full = native.render(scene, RenderOptions()), native.render(scene, EVERYTHING)
    assert np.array_equal(gated.image, full.image)
