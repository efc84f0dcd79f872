"""Rounding has to explain an image: as many pixels depart from truth as samples of it depart."""

from __future__ import annotations

from dataclasses import replace
from importlib.resources import as_file, files

import numpy as np
import pytest

from crosstrace.translators.course import load
from crosstrace.translators.ledger import Arithmetic, Emulation
from crosstrace.translators.native.departures import as_often_as_samples
from crosstrace.translators.native.truth import certify
from crosstrace.translators.registry import renderer
from crosstrace.translators.renderer import RenderOptions
from crosstrace.translators.scene import Scene

UNIT = 2.0**-24
FLOAT32 = Arithmetic(UNIT, 2.0, UNIT)
TOLERANCE = 1e-5


def small(name: str) -> Scene:
    with as_file(files("crosstrace.scenes") / "course" / f"{name}.txt") as file:
        return load(file).resized(60, 80)


def rendered(scene: Scene, precision: str = "f64") -> np.ndarray:
    return renderer("native").render(scene, RenderOptions(precision=precision)).image


def is_believed(scene: Scene, image: np.ndarray) -> bool:
    known = certify(scene)
    middle = 0.5 * (known.lo + known.hi)
    departing = np.asarray((np.abs(image - middle) > TOLERANCE).any(axis=2))
    slack = np.full(departing.shape, TOLERANCE)
    return as_often_as_samples(Emulation(scene, {}), known, departing, slack, FLOAT32)


@pytest.mark.parametrize("name", ["terra", "eclipse"])
def test_an_honest_float32_image_departs_as_often_as_samples(name: str) -> None:
    """Where it is shadow rays that meet their own surface at float32."""
    scene = small(name)
    assert is_believed(scene, rendered(scene, "f32"))


def test_an_exact_image_departs_too_rarely() -> None:
    """Where float32 would have hundreds of pixels depart, none is not what it returns."""
    scene = small("terra")
    assert not is_believed(scene, rendered(scene))


def test_a_light_left_out_departs_too_often() -> None:
    """Though each pixel alone could be a shadow ray that met its own surface."""
    scene = small("terra")
    dark = replace(scene, lights=scene.lights[1:], checked=False)
    assert not is_believed(scene, rendered(dark))


def test_arithmetic_that_never_rounds_a_pixel_over_believes_none() -> None:
    """In double nothing departs: an equal image is believed, and one departing region is not."""
    scene = small("venn")
    image = rendered(scene)
    known, slack = certify(scene), np.full(image.shape[:2], TOLERANCE)
    double = Arithmetic(2.0**-53, 2.0, 2.0**-53)
    for rows, believed in ((0, True), (10, False)):
        departing = np.zeros(image.shape[:2], np.bool_)
        departing[:rows] = True
        meaning = Emulation(scene, {})
        assert as_often_as_samples(meaning, known, departing, slack, double) == believed
