"""The units of rounding that ledgers declare explain the lanes' images; far fewer would not.

Honest images, classed: what no sample of the declared arithmetic returns is suspect or wrong.
"""

from __future__ import annotations

from dataclasses import replace

import pytest

from crosstrace.harness import alone
from crosstrace.harness.arithmetics import Way, ways
from crosstrace.harness.classes import classify
from crosstrace.harness.sources import find_one
from crosstrace.translators.native.truth import certify
from crosstrace.translators.registry import LANES, renderer
from crosstrace.translators.renderer import RenderOptions
from crosstrace.translators.scene import Scene

SIZE = (120, 160)


def asked(lane: str, scene: Scene, precision: str) -> Way:
    """The way of native in a precision, or the one of another lane."""
    if not alone.probe(lane).available:
        pytest.skip(f"{lane} is not installed")
    return next(w for w in ways(lane, scene) if lane != "native" or w.precision == precision)


def unexplained(
    lane: str, scene: Scene, precision: str = "f64", kappas: tuple[float, ...] = ()
) -> list[tuple[int, int]]:
    """The (suspect, wrong) pixels of one image under each κ, by default under the declared one."""
    way = asked(lane, scene, precision)
    options = RenderOptions(precision=precision, timeout_s=300)
    made = renderer(lane).render(scene, options)
    ledger, known = renderer(lane).ledger(scene), certify(scene)
    found = []
    for kappa in kappas or (way.arithmetic.kappa,):
        declared = replace(ledger, arithmetic=replace(way.arithmetic, kappa=kappa))
        counts = classify(scene, known, made.image, declared, half_step=made.half_step).counts
        found.append((counts["suspect"], counts["wrong"]))
    return found


@pytest.mark.slow
@pytest.mark.parametrize(("lane", "precision"), [*((lane, "f64") for lane in LANES),
                                                 ("native", "f32")])  # fmt: skip
@pytest.mark.parametrize("name", ["espelho3", "piramide", "terra", "vidro4"])
def test_the_declared_units_explain_an_honest_image(lane: str, precision: str, name: str) -> None:
    """No pixel of a scene of the course is wrong or suspect."""
    assert unexplained(lane, find_one(name, size=SIZE).scene, precision) == [(0, 0)]


@pytest.mark.parametrize(
    ("lane", "precision", "name", "too_few"),
    [
        ("native", "f32", "piramide", 1.0),
        ("mitsuba-f64", "f64", "huge-exponent", 0.25),
        ("povray", "f64", "light-on-sphere", 0.25),
    ],
)
def test_fewer_units_leave_pixels_of_an_honest_image_unexplained(
    lane: str, precision: str, name: str, too_few: float
) -> None:
    """Where rounding is seen, some pixels are suspect under too few units, under 2 none is."""
    size = SIZE if name == "piramide" else None
    scene = find_one(name, size=size).scene
    (few, _), (enough, wrong) = unexplained(lane, scene, precision, (too_few, 2.0))
    assert few > 0
    assert (enough, wrong) == (0, 0)
