"""The numerically hard scenes: what is known of their answers holds."""

from __future__ import annotations

import json
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from crosstrace.translators.course import load
from crosstrace.translators.native.adapter import PRECISIONS
from crosstrace.translators.native.stability import compare_rungs
from crosstrace.translators.native.thresholds import departures
from crosstrace.translators.native.truth import Decision, certify
from crosstrace.translators.registry import renderer
from crosstrace.translators.renderer import RenderOptions
from crosstrace.translators.scene import Scene

FOLDER = Path(str(files("crosstrace.scenes") / "hard"))
INDEX: list[dict[str, Any]] = json.loads((FOLDER / "index.json").read_text(encoding="utf-8"))
NAMES = [entry["name"] for entry in INDEX]
BY_NAME = {entry["name"]: entry for entry in INDEX}

#: Scenes that real arithmetic itself leaves open in more than one pixel of a hundred.
OPEN = {"coincident-respelled"}


def scene(name: str) -> Scene:
    return load(FOLDER / f"{name}.txt")


def native(name: str, precision: str = "f64") -> np.ndarray:
    return renderer("native").render(scene(name), RenderOptions(precision=precision)).image


def squared_tangent(of: Scene) -> np.ndarray:
    """Return tan² of the angle between each pixel's ray and the axis, (v_res, h_res)."""
    x = of.pixel_size * (np.arange(of.h_res) - of.h_res / 2 + 0.5)
    y = of.pixel_size * (np.arange(of.v_res) - of.v_res / 2 + 0.5)
    return (x[None, :] ** 2 + y[:, None] ** 2) / of.screen_distance**2


def test_the_index_names_every_file_and_what_is_hard_about_it() -> None:
    """At least 20 scenes in named families, each with a line on the difficulty and the answer."""
    assert sorted(entry["file"] for entry in INDEX) == sorted(p.name for p in FOLDER.glob("*.txt"))
    assert len(INDEX) >= 20 and len({entry["family"] for entry in INDEX}) >= 15
    assert all(entry["about"] and entry["known"] for entry in INDEX)


@pytest.mark.parametrize("name", NAMES)
def test_every_pixel_is_certified_or_open_for_a_reason(name: str) -> None:
    """Enclosures are narrower than 1e-9, hold float128, and what is open says which decision."""
    known = certify(scene(name))
    decided = ~known.undecidable
    assert (known.hi - known.lo)[decided].max(initial=0) <= 1e-9
    assert (known.decision[~decided] != Decision.NONE).all()
    assert known.contains(native(name, "f128")).all()
    assert (known.certified_fraction >= 0.99) == (name not in OPEN)


@pytest.mark.parametrize("name", NAMES)
def test_every_rung_stays_numerically_stable(name: str) -> None:
    """Each precision keeps the index's thresholds, and double what double intervals can decide."""
    _, rungs = compare_rungs(scene(name))
    assert departures(rungs, BY_NAME[name]["stable"]) == []
    for rung in rungs:
        if rung.precision != "f32":
            assert rung.by_level[0] == 0, rung.precision


def test_every_rung_has_a_threshold_and_a_loose_one_its_reason() -> None:
    """What a scene costs beyond the ordinary is explained by naming the rung."""
    for entry in INDEX:
        assert list(entry["stable"]) == [*PRECISIONS][:-1], entry["name"]
        for rung, limits in entry["stable"].items():
            most_trees, most_error = (50, 1e-4) if rung == "f32" else (0, 1e-12)
            if limits["changed_trees"] > most_trees or limits["error"] > most_error:
                assert rung in entry.get("why", ""), (entry["name"], rung)


def test_identical_surfaces_show_the_first_in_the_file() -> None:
    """The wall and the ball have half their own colour: ka = 1/2 in white light."""
    image = native("coincident")
    assert np.abs(image[0, 0] - np.array([200, 40, 40]) / 510).max() <= 1e-15
    assert np.abs(image[30, 48] - np.array([40, 40, 200]) / 510).max() <= 1e-15


def test_one_plane_spelled_twice_is_open_between_its_two_colours() -> None:
    """No other colour is possible, and each alternative is one of the two."""
    known = certify(scene("coincident-respelled"))
    for color in ([200, 40, 40], [40, 200, 40]):
        image = np.broadcast_to(np.array(color) / 510, (61, 81, 3))
        assert known.fits_alternative(image, 1e-15)[known.undecidable].all()
    mixed = np.broadcast_to(np.array([120, 120, 40]) / 510, (61, 81, 3))
    assert not known.fits_alternative(mixed, 1e-3)[known.undecidable].any()


def test_the_eye_on_a_sphere_sees_its_far_side() -> None:
    """Every pixel has half the sphere's colour; none sees through the surface that it stands on."""
    assert np.abs(native("eye-on-sphere") - np.array([200, 40, 40]) / 510).max() <= 1e-15


def test_a_far_tiny_sphere_is_lit_from_the_eye_in_its_middle() -> None:
    """At the centre n·l is 1: the pixel is (ka + kd) times the colour."""
    assert np.abs(native("far-tiny")[30, 40] - 0.75 * np.array([200, 60, 60]) / 255).max() <= 1e-9


@pytest.mark.parametrize("precision", ["f64c", "dd", "f128"])
def test_a_huge_exponent_has_its_highlight(precision: str) -> None:
    """With light at the eye r·ωo is cos 2a = (1 − t²)/(1 + t²), t the tangent of the angle."""
    t2 = squared_tangent(scene("huge-exponent"))
    expected = np.exp(1e6 * (np.log1p(-t2) - np.log1p(t2)))
    assert np.abs(native("huge-exponent", precision)[..., 0] - expected).max() <= 1e-9


def test_a_fractional_exponent_has_its_highlight() -> None:
    """On the wall the pixel is cos(2a)^0.3 / 2."""
    image, t2 = native("fractional-exponent"), squared_tangent(scene("fractional-exponent"))
    wall = t2 > 0.2
    cosine = (1 - t2) / (1 + t2)
    expected = 0.5 * np.maximum(cosine, 0) ** 0.3
    assert wall.any() and np.abs(image[..., 0] - expected)[wall].max() <= 1e-12
