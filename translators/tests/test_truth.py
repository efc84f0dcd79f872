"""Certified pixels: enclosures hold the tracer's values, and what is open is said to be open."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from crosstrace.translators.course import load, parse
from crosstrace.translators.errors import UsageError
from crosstrace.translators.native.truth import Decision, PixelClass, certify
from crosstrace.translators.registry import renderer
from crosstrace.translators.renderer import RenderOptions
from crosstrace.translators.scene import Scene

GLASS = (
    "45 60 0.027 1 0 -6 1.5 0 0 0.8 0 0 1 120 170 230 4 5 "
    "220 220 220 0.2 0.7 0.3 1 0.2 0 1 / 0 0 0 0.1 0 2 "
    "230 60 60 0.1 0.7 0.4 50 0.1 0.4 0.7 * -1.1 1 1 1 "
    "30 30 30 0.0 0.1 0.5 20.5 0.1 0.8 1.5 * 0 -0.5 1 1 "
    "30 30 90 0.0 0.1 0.5 200 0 0.8 0.8 * 0.1 -0.5 1.1 0.4 "
    "60 60 230 0.1 0.7 0.4 20 0.6 0 0.5 * 1.3 1.2 1 1 "
    "255 255 255 2 150 150 150 -4 -5 6 220 120 120 3 -2 5"
)
READINGS = [
    "mix=convex",
    "plane_normal=raw",
    "lighting_normal=facing",
    "view=eye",
    "specular_gate=lit",
    "glass_shadow=clear",
    "shadow_distance=ignored",
    "epsilon=1e-3",
    "offset=normal",
    "offset=mitsuba",
    "epsilon_twice=yes",
    "depth=minus-one",
    "depth=plus-one",
    "exhausted=background",
    "miss=black",
    "refraction=inverted",
    "refraction=one-way",
    "nesting=tracked",
    "nesting=interiors",
    "tir=ignore",
    "tir=add",
    "tir=plus-one",
    "tir=needs-kr",
    "tir=always",
    "inner_reflection=off",
    "recursion=clamp",
    "recursion=scale",
    "shadow_min=1e-3",
    "far=20",
]

#: Pixel centres lie exactly on edges here: an odd resolution, and symmetric surfaces.
CORNER = (
    "31 31 0.05 1 0 1 5 0 0 0 0 1 0 90 90 90 1 4 "
    "200 60 60 0.2 0.6 0.2 9 0 0 1 / 0 0 0 1 0 1 60 200 60 0.2 0.6 0.2 9 0.2 0 1 / 0 0 0 -1 0 1 "
    "60 60 200 0.2 0.6 0.2 9 0 0 1 / 0 -2 0 0 1 0 90 90 90 0.1 0.6 0.5 9 0.3 0 1 * 0 -1 0 1 "
    "255 255 255 1 255 255 255 0 4 6"
)

#: Rounding of the tracer in double, where no decision hangs on it.
ROUNDING = 1e-11


def _native(scene: Scene, readings: dict[str, str]) -> np.ndarray:
    return renderer("native").render(scene, RenderOptions(readings=readings)).image


@pytest.mark.parametrize("reading", ["", *READINGS])
def test_the_tracer_lies_inside_its_enclosures_under_every_reading(reading: str) -> None:
    """Two texts of one meaning agree wherever the scene decides, which is nearly everywhere."""
    readings = dict([reading.split("=")]) if reading else {}
    scene = parse(GLASS)
    known = certify(scene, readings)
    assert known.certified_fraction >= 0.995
    inside = known.contains(_native(scene, readings), ROUNDING)
    assert inside[~known.undecidable].all()
    width = (known.hi - known.lo)[~known.undecidable]
    assert width.min() >= 0 and width.max() <= 1e-9


def test_every_reading_that_changes_the_image_changes_the_enclosures() -> None:
    """A reading that the certified kernel forgot would leave its enclosures where they were."""
    scene = parse(GLASS)
    plain = certify(scene)
    for reading in READINGS:
        name, value = reading.split("=")
        image = _native(scene, {name: value})
        moved = ~plain.contains(image, ROUNDING) & ~plain.undecidable
        known = certify(scene, {name: value})
        assert known.contains(image, ROUNDING)[moved & ~known.undecidable].all()


@pytest.mark.parametrize("name", ["bolha2", "espelho0", "espelho2", "japao", "olho", "terra",
                                  "venn", "vidro4"])  # fmt: skip
def test_official_scenes_are_certified(official: Path, name: str) -> None:
    """Every pixel of the course's scenes is enclosed to 1e-9, the eye on a plane included."""
    scene = load(official / f"{name}.txt")
    known = certify(scene)
    assert known.certified_fraction == 1.0
    assert known.contains(_native(scene, {}), ROUNDING).all()


def test_some_pixels_are_certified_as_in_the_whole_frame() -> None:
    """A list of pixels gives the entries of the whole frame, in the order asked for."""
    scene = parse(GLASS)
    whole = certify(scene)
    pixels = np.array([1234, 0, 2699, 77])
    some = certify(scene, pixels=pixels)
    assert np.array_equal(some.lo, whole.lo.reshape(-1, 3)[pixels])
    assert np.array_equal(some.hi, whole.hi.reshape(-1, 3)[pixels])


def test_an_edge_is_undecidable_and_its_alternatives_are_listed() -> None:
    """Where two planes meet at an irrational distance, either colour fits, and no mixture does."""
    scene = parse("1 1 1 1 0 1 5 0 0 0 0 1 0 0 0 51 2 255 0 0 / 0 0 0 1 0 1 0 255 0 / 0 0 0 -1 0 1")
    known = certify(scene)
    assert known.pixel_class.item() == PixelClass.EDGE
    assert known.decision.item() == Decision.NEAREST
    for color, fits in (([1.0, 0, 0], True), ([0, 1.0, 0], True), ([0.5, 0.5, 0], False)):
        image = np.array(color).reshape(1, 1, 3)
        assert known.contains(image).all()
        assert known.fits_alternative(image, 1e-12).all() == fits


def test_rounding_in_float32_stays_inside_the_inflated_enclosures() -> None:
    """With the error of the arithmetic under test let in, an honest float32 renderer fits."""
    scene = parse(GLASS)
    assert renderer("mitsuba").name == "mitsuba"
    truth = _native(scene, {})
    inflated = certify(scene, kappa=3 * 2.0**-24)
    nudged = truth.astype(np.float32).astype(np.float64)
    assert inflated.contains(nudged).all()
    assert ((inflated.hi - inflated.lo) > 0).any()


def test_an_offset_without_a_meaning_in_real_arithmetic_is_refused() -> None:
    """offset=bound depends on rounding, and truth does not round."""
    with pytest.raises(UsageError, match="offset=bound"):
        certify(parse(GLASS), {"offset": "bound"})


def test_the_number_of_threads_changes_no_bit() -> None:
    """Pixels are enclosed one by one."""
    scene = parse(GLASS)
    one, three = certify(scene, threads=1), certify(scene, threads=3)
    assert np.array_equal(one.lo, three.lo) and np.array_equal(one.hi, three.hi)


@pytest.mark.parametrize(
    "habits",
    [
        {"offset": "mitsuba"},
        {"epsilon": "1e-4", "shadow_min": "1e-3", "light_min": "1e-3", "far": "50",
         "nesting": "interiors", "index": "float32"},
    ],
    ids=["mitsuba", "povray"],
)  # fmt: skip
def test_float128_lies_inside_the_enclosures_of_a_renderers_habits(habits: dict[str, str]) -> None:
    """The readings that lanes are certified under are enclosed as the specification's own are."""
    scene = parse(GLASS)
    options = RenderOptions(precision="f128", readings=habits)
    known = certify(scene, habits)
    assert known.contains(renderer("native").render(scene, options).image).all()
    assert known.closed["double"] > 0.98 * known.pixel_class.size


@pytest.mark.parametrize("text", [GLASS, CORNER], ids=["glass", "corner"])
def test_float128_lies_inside_the_double_enclosures(text: str) -> None:
    """The widest arithmetic of the tracer never leaves an enclosure, decided or not."""
    scene = parse(text)
    options = RenderOptions(precision="f128")
    image = renderer("native").render(scene, options).image
    known = certify(scene)
    assert known.contains(image).all()
    assert known.fits_alternative(image, 1e-15).all()
