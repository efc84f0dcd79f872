"""Renderers keep their picture where a change must not show, and a real change is found."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from crosstrace.harness import alone, metamorphic
from crosstrace.harness.arithmetics import ways
from crosstrace.harness.metamorphic import Outcome, check
from crosstrace.harness.sources import find_one, hard_names
from crosstrace.native import _core
from crosstrace.translators.metamorphic import RELATIONS, Relation, scaled, translated
from crosstrace.translators.renderer import RenderOptions
from crosstrace.translators.scene import Scene


def scene(name: str) -> Scene:
    found = find_one(name).scene
    return found if found.v_res <= 61 else found.resized(30, 40)


def broken(outcomes: list[Outcome]) -> list[str]:
    return [f"{it.relation} {it.precision}: {it.over} of {it.compared}, {it.max} > {it.bound}"
            for it in outcomes if it.over]  # fmt: skip


@pytest.mark.parametrize("name", ["index-above-one", "canto", "coordinates-1e-3", "edge-centres",
                                  "light-on-plane"])  # fmt: skip
def test_native_keeps_its_picture_in_every_precision(name: str) -> None:
    """All relations hold within their bounds; those that change no operation to the bit."""
    outcomes = check("native", scene(name), RenderOptions())
    assert broken(outcomes) == []
    assert len(outcomes) == len(RELATIONS) * len(_core.precisions())
    by = {(it.relation, it.precision): it for it in outcomes}
    for it in outcomes:
        assert not it.own_rule
        if it.relation in ("scale-1024", "scale-1/64", "channels"):
            assert (it.max, it.compared) == (0.0, it.pixels)
    # Whether a light on a surface is behind it is a toss-up to rounding: such pixels are left out.
    if name != "light-on-plane":
        assert by["axes", "f64"].compared > 0.9 * by["axes", "f64"].pixels


@pytest.mark.slow
@pytest.mark.parametrize("name", hard_names())
def test_native_keeps_its_picture_of_the_hard_scenes(name: str) -> None:
    """All relations hold on every hard scene and precision."""
    assert broken(check("native", scene(name), RenderOptions())) == []


@pytest.mark.parametrize("lane", ["mitsuba", "mitsuba-f64", "povray"])
@pytest.mark.parametrize("name", ["sinuca", "coordinates-1e-3"])
def test_other_renderers_keep_their_picture(lane: str, name: str) -> None:
    """They hold what they must, and change by rules of their own exactly as these rules say."""
    if not alone.probe(lane).available:
        pytest.skip(f"{lane} is not installed")
    outcomes = check(lane, scene(name), RenderOptions(timeout_s=120))
    assert broken(outcomes) == []
    assert all(it.compared > 0.9 * it.pixels for it in outcomes)
    own = {it.relation for it in outcomes if it.own_rule}
    assert (
        own
        == {
            "mitsuba": {r.name for r in RELATIONS if r.moves},
            "mitsuba-f64": {r.name for r in RELATIONS if r.factor != 1},
            "povray": own & {"scale-1024", "scale-1/64", "scale-3"},
        }[lane]
    )


def test_a_fixed_offset_shows_when_a_small_scene_shrinks() -> None:
    """mitsuba-f64 has ε in world units: the picture changes much, and just as that says."""
    if not alone.probe("mitsuba-f64").available:
        pytest.skip("mitsuba-f64 is not installed")
    outcomes = check("mitsuba-f64", scene("coordinates-1e-3"), RenderOptions())
    shrunk = next(it for it in outcomes if it.relation == "scale-1/64")
    assert shrunk.max is not None and shrunk.max > 0.1 and shrunk.own_rule and not shrunk.over


def _light_left_behind(before: Scene) -> Scene:
    return replace(translated(before, (0.125, 0, 0)), lights=before.lights)


@pytest.mark.parametrize("fault", [
    Relation("epsilon-forgotten", lambda s: scaled(s, 1 / 64), exact=True, rounds=False),
    Relation("light-left", _light_left_behind),
    Relation("color-off", lambda s: replace(s, color=s.color * (1 - 1e-9)), moves=False),
    Relation("radius-off", lambda s: replace(s, geometry=s.geometry * (1 + 1e-9))),
], ids=lambda relation: relation.name)  # fmt: skip
def test_a_change_that_matters_is_found(fault: Relation, monkeypatch: pytest.MonkeyPatch) -> None:
    """A transformation with a mistake in it leaves the bounds in double, however small it is."""
    monkeypatch.setattr(metamorphic, "RELATIONS", (fault,))
    outcomes = check("native", scene("coordinates-1e-3"), RenderOptions())
    double = next(it for it in outcomes if it.precision == "f64")
    assert double.over > 0


def test_bounds_grow_with_the_unit_of_the_arithmetic() -> None:
    """Where nothing but rounding differs, wider types are held to smaller differences."""
    outcomes = check("native", scene("light-on-plane"), RenderOptions())
    for relation in ("split-lights", "axes"):
        bounds = [it.bound for it in outcomes if it.relation == relation]
        assert all(bound is not None for bound in bounds)
        assert np.all(np.diff(np.array(bounds, np.float64)) <= 0)
        assert bounds[-1] < 1e-20 < bounds[0]  # type: ignore[operator]


def test_every_lane_says_how_it_computes() -> None:
    """Each has at least one arithmetic under its own name, native one for every precision."""
    some = scene("sinuca")
    assert [way.precision for way in ways("native", some)] == _core.precisions()
    for lane in ("mitsuba", "mitsuba-f64", "povray"):
        assert [way.lane for way in ways(lane, some)] == [lane]
