"""Faults planted in float32 renders: what the class of a pixel can tell from rounding."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from crosstrace.harness.classes import Class, classify
from crosstrace.harness.faults import scene_edits
from crosstrace.harness.sources import find_one
from crosstrace.translators.ledger import Arithmetic, Ledger
from crosstrace.translators.native.truth import certify
from crosstrace.translators.registry import renderer
from crosstrace.translators.renderer import RenderOptions
from crosstrace.translators.scene import Scene

FLOAT32 = Ledger((), Arithmetic(2.0**-24, 2.0, 2.0**-24))
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


def share_caught(name: str, fault: str, size: tuple[int, int]) -> float | None:
    """The share that is wrong or suspect, of the pixels that the fault moves beyond tolerance.

    None where it moves fewer than 50.
    """
    scene = find_one(name, size=size).scene
    faulty = FAULTS[fault](scene)
    if faulty is None:
        return None
    found = classify(scene, certify(scene), image(faulty, "f32"), FLOAT32)
    moved = np.abs(image(faulty, "f64") - image(scene, "f64")).max(axis=-1) > found.tolerance
    if moved.sum() < 50:
        return None
    return float(found.pixels(Class.WRONG, Class.SUSPECT)[moved].mean())


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
    share = share_caught(name, fault, (60, 80))
    assert share is not None
    assert share >= 0.9
