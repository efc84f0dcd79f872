"""The catalogue of faults: its names, where there is nothing to break, and that each one shows."""

from __future__ import annotations

import re

import numpy as np
import pytest
from fault_examples import EXAMPLES, OPTIONS, example, honest, need, small

from crosstrace.harness import tasks
from crosstrace.harness.faults import (
    FAULTS,
    changed_pixels,
    fault,
    plantings,
    render_here,
    render_with,
)
from crosstrace.translators.errors import UsageError
from crosstrace.translators.registry import LANES
from crosstrace.translators.scene import Scene

#: The names that others rely on.
STABLE = """
    epsilon-zero no-shadow glass-lets-light-through n-inverted one-bounce-fewer one-bounce-more
    normals-flipped no-total-reflection gain-1-percent half-pixel-shift clamp-instead-of-scale
    srgb-applied image-mirrored one-object-missing one-light-missing eta-plus-one u-and-v-swapped
    n-times-1.001 kd-times-1.002 light-moved-1e-2 radius-times-1.001
"""

#: Faults that need no light, no bounce and no material.
OF_ANY_SCENE = {
    "gain-1-percent", "half-pixel-shift", "camera-turned-half-a-pixel", "srgb-applied",
    "image-mirrored", "u-and-v-swapped", "one-object-missing", "radius-times-1.001",
}  # fmt: skip

PLANTED = [(lane, known.name) for lane in LANES for known in plantings(lane)]


def test_names_are_stable_kebab_case_and_unique() -> None:
    """Every name that a verdict or a table may hold is there once, with a sentence and a lane."""
    names = [known.name for known in FAULTS]
    assert len(set(names)) == len(names)
    assert set(STABLE.split()) <= set(names)
    for known in FAULTS:
        assert re.fullmatch(r"[a-z0-9.]+(-[a-z0-9.]+)+", known.name)
        assert known.sentence.endswith(".")
        assert known.lanes
        assert set(known.lanes) <= set(LANES)
        assert fault(known.name) is known


def test_every_lane_has_readings_texts_scenes_or_images_of_its_own_to_break() -> None:
    """Native alone has readings; three texts at least are edited in each of the other lanes."""
    for lane in LANES:
        kinds = [known.kind(lane) for known in plantings(lane)]
        assert ("reading" in kinds) == (lane == "native")
        assert (kinds.count("text edit") >= 3) == (lane != "native")
        assert kinds.count("image operation") >= 3
        assert kinds.count("scene edit") >= 3


def test_a_wrong_name_of_a_fault_or_lane_is_refused() -> None:
    """The message says what there is; nothing is rendered."""
    with pytest.raises(UsageError, match=r"expected a fault out of epsilon-zero, .*found 'acne'"):
        fault("acne")
    with pytest.raises(UsageError, match="expected a lane out of native, found povray"):
        render_with("epsilon-zero", "povray", small("venn"))


@pytest.mark.parametrize("name", [name for lane, name in PLANTED if lane == "native"])
def test_a_fault_shows_in_the_native_tracer_and_leaves_the_scene_alone(name: str) -> None:
    """More than 20 pixels change; the scene keeps every number, and renders to the same bits."""
    scene = example(name)
    before, sha256 = scene.native_view(), scene.sha256
    made = render_here(name, "native", scene, OPTIONS)
    assert made is not None
    assert changed_pixels("native", honest("native", EXAMPLES.get(name, "bolha4")), made) > 20
    assert scene.sha256 == sha256
    assert all(now is then for now, then in zip(scene.native_view(), before, strict=True))
    again = tasks.render("native", scene, OPTIONS)[0].image
    assert np.array_equal(again, honest("native", EXAMPLES.get(name, "bolha4")).image)


@pytest.mark.slow
@pytest.mark.parametrize(("lane", "name"), [it for it in PLANTED if it[0] != "native"])
def test_a_fault_shows_in_every_lane_that_it_claims(lane: str, name: str) -> None:
    """More than 20 pixels change."""
    need(lane)
    made = render_here(name, lane, example(name), OPTIONS)
    assert made is not None
    assert changed_pixels(lane, honest(lane, EXAMPLES.get(name, "bolha4")), made) > 20


@pytest.mark.parametrize(
    "lane",
    [
        "native",
        "mitsuba-f64",
        pytest.param("mitsuba", marks=pytest.mark.slow),
        pytest.param("povray", marks=pytest.mark.slow),
    ],
)
def test_the_first_delivery_has_no_light_bounce_or_highlight_to_break(lane: str) -> None:
    """Nothing but size, place, camera and image can be wrong there: η + 1 is no fault."""
    need(lane)
    changed = {
        known.name
        for known in plantings(lane)
        if render_here(known.name, lane, small("olho"), OPTIONS) is not None
    }
    more = {"native": set(), "povray": {"gamma-decoded", "last-object-unwritten"}}
    assert changed == OF_ANY_SCENE | more.get(lane, {"last-object-unwritten"})


@pytest.mark.parametrize(
    ("name", "scene"),
    [
        ("one-bounce-fewer", "espelho0"),
        ("one-bounce-more", "venn"),
        ("n-inverted", "espelho2"),
        ("no-total-reflection", "espelho2"),
        ("glass-lets-light-through", "venn"),
        ("epsilon-zero", "olho"),
        ("normals-flipped", "eclipse"),
        ("clamp-instead-of-scale", "olho"),
    ],
)
def test_a_scene_that_lacks_the_thing_has_nothing_to_break(name: str, scene: str) -> None:
    """No bounce, no glass, no light, no plane or nothing beyond 1: there is no faulty image."""
    assert render_here(name, "native", small(scene), OPTIONS) is None


@pytest.mark.parametrize("name", [known.name for known in plantings("native")])
def test_an_empty_scene_breaks_no_fault(name: str) -> None:
    """Without objects and lights a fault is either none, or an image of the background."""
    empty = Scene.build(
        delivery=3, v_res=6, h_res=8, pixel_size=0.1, screen_distance=1.0, eye=[0, 0, 3],
        target=[0, 0, 0], up=[0, 1, 0], background=[10, 20, 30], max_depth=2,
    )  # fmt: skip
    made = render_here(name, "native", empty, OPTIONS)
    # A picture of one colour looks the same from everywhere: only its values can be wrong.
    if made is not None and not np.allclose(made.image, np.array([10, 20, 30]) / 255, rtol=1e-12):
        assert name in {"gain-1-percent", "srgb-applied"}


def test_a_fault_is_planted_in_a_worker_process_by_name() -> None:
    """The worker returns what this process renders, and None where there is nothing to break."""
    scene = small("venn")
    there = render_with("one-light-missing", "native", scene, OPTIONS)
    here = render_here("one-light-missing", "native", scene, OPTIONS)
    assert there is not None
    assert here is not None
    assert np.array_equal(there.image, here.image)
    assert render_with(fault("one-bounce-fewer"), "native", scene) is None
