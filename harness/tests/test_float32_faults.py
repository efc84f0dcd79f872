"""Faults planted in float32 renders: what the class of a pixel can tell from rounding."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from crosstrace.harness.classes import Class, classify
from crosstrace.harness.faults import scene_edits
from crosstrace.harness.sources import find_one, packaged_names
from crosstrace.translators.ledger import Ledger
from crosstrace.translators.native.adapter import arithmetic
from crosstrace.translators.native.truth import certify
from crosstrace.translators.registry import renderer
from crosstrace.translators.renderer import RenderOptions
from crosstrace.translators.scene import Scene

FLOAT32 = Ledger((), arithmetic("f32"))
FAULTS = {
    "one bounce fewer": scene_edits.one_bounce_fewer,
    "n * 1.001": scene_edits.indices_off,
    "kd * 1.002": scene_edits.diffuse_off,
    "eta + 1": scene_edits.exponents_off,
    "light moved": scene_edits.light_moved,
    "radius * 1.001": scene_edits.radii_off,
}


def image(scene: Scene, precision: str) -> NDArray[np.float64]:
    return renderer("native").render(scene, RenderOptions(precision=precision)).image


def caught(name: str, fault: str, size: tuple[int, int]) -> NDArray[np.int64]:
    """Pixels that the fault moves beyond tolerance; those of them that are wrong, and suspect."""
    scene = find_one(name, size=size).scene
    faulty = FAULTS[fault](scene)
    if faulty is None:
        return np.zeros(3, np.int64)
    found = classify(scene, certify(scene), image(faulty, "f32"), FLOAT32)
    moved = np.abs(image(faulty, "f64") - image(scene, "f64")).max(axis=-1) > found.tolerance
    of_them = (found.pixels(kind) & moved for kind in (Class.WRONG, Class.SUSPECT))
    return np.array([moved.sum(), *(which.sum() for which in of_them)])


@pytest.mark.parametrize(
    ("name", "fault"),
    [
        ("espelho3", "one bounce fewer"),
        ("vidro4", "n * 1.001"),
        ("espelho2", "kd * 1.002"),
        ("sinuca", "eta + 1"),
        ("venn", "light moved"),
        ("terra", "radius * 1.001"),
    ],
)
def test_a_fault_is_told_from_float32_rounding(name: str, fault: str) -> None:
    """Nine in ten of the pixels that it moves are wrong or suspect."""
    moved, wrong, suspect = caught(name, fault, (60, 80))
    assert moved >= 50
    assert wrong + suspect >= 0.9 * moved


@pytest.mark.slow
@pytest.mark.parametrize("fault", FAULTS)
def test_a_fault_is_told_from_float32_rounding_over_all_course_scenes(fault: str) -> None:
    """Two thirds of the pixels that it moves, taken together; `-rP` shows the README's table."""
    moved, wrong, suspect = sum(caught(name, fault, (120, 160)) for name in packaged_names())
    print(f"{fault}: {moved} moved, wrong {wrong / moved:.3f}, suspect {suspect / moved:.3f}")
    assert wrong + suspect >= 0.66 * moved
