"""No two different references pass as each other: each reading's picture is right under its own."""

from __future__ import annotations

from functools import cache
from itertools import permutations

import numpy as np
import pytest
from fault_examples import small

from crosstrace.harness.against_truth import compare_with_truth
from crosstrace.harness.mutation import CHANGED_ENOUGH
from crosstrace.native import _core
from crosstrace.translators.registry import renderer
from crosstrace.translators.renderer import RenderOptions

#: Where a ray starts exactly on its surface, real arithmetic does not decide whether it hits it
#: again: the truth under this reading is open in a seventh of a picture with glass, so that it
#: speaks against nobody there (and takes float128 to find out).
OPEN = "epsilon_for"

#: Numbers to take where a reading is one; world units that show in the scenes below.
NUMBERS = {"epsilon": "1e-2", "shadow_min": "1", "light_min": "5", "far": "20"}


def catalogue() -> list[dict[str, str]]:
    """Return the default and every single departure from it, one value each."""
    found: list[dict[str, str]] = [{}]
    for name, default, values in _core.readings():
        if name == OPEN:
            continue
        others = [NUMBERS[name]] if name in NUMBERS else values.split("|")
        found += [{name: value} for value in others if value != default]
    return found


@cache
def picture(scene: str, rows: int, columns: int, index: int) -> np.ndarray:
    options = RenderOptions(threads=1, readings=catalogue()[index])
    return renderer("native").render(small(scene, rows, columns), options).image


def n_apart(a: np.ndarray, b: np.ndarray) -> int:
    return int(np.count_nonzero(np.abs(a - b).max(axis=2) > 1e-9))


def apart(scene: str, rows: int, columns: int) -> list[int]:
    """Return indices of readings whose pictures all differ from each other in enough pixels."""
    chosen: list[int] = []
    for index in range(len(catalogue())):
        image = picture(scene, rows, columns, index)
        others = (picture(scene, rows, columns, other) for other in chosen)
        if all(n_apart(image, other) > CHANGED_ENOUGH for other in others):
            chosen.append(index)
    return chosen


def check(scene: str, rows: int, columns: int, least: int) -> None:
    chosen = apart(scene, rows, columns)
    assert len(chosen) >= least
    readings = catalogue()
    for index in chosen:
        own = compare_with_truth(
            picture(scene, rows, columns, index), small(scene, rows, columns),
            readings=readings[index],
        )  # fmt: skip
        assert own.right, (readings[index], own.counts)
    for index, other in permutations(chosen, 2):
        opinion = compare_with_truth(
            picture(scene, rows, columns, index), small(scene, rows, columns),
            readings=readings[other],
        )  # fmt: skip
        assert not opinion.right, (readings[index], readings[other], opinion.counts)


def test_no_reading_s_picture_passes_under_another() -> None:
    """Every ordered pair of readings that differ in more than 20 pixels of a glass scene."""
    check("bolha4", 24, 32, least=12)


@pytest.mark.slow
@pytest.mark.parametrize("scene", ["vidro4", "bolha2", "espelho3", "venn", "terra", "nested-glass"])
def test_no_reading_s_picture_passes_under_another_in_more_scenes(scene: str) -> None:
    """At 48 x 64, scenes of every delivery."""
    check(scene, 48, 64, least=3)
