"""The FLIP difference, where its package is installed."""

from __future__ import annotations

import sys
from importlib.util import find_spec

import numpy as np
import pytest

from crosstrace.harness.flip import flip


def test_without_its_package_there_is_no_number(monkeypatch: pytest.MonkeyPatch) -> None:
    """None, and nothing is raised."""
    monkeypatch.setitem(sys.modules, "flip_evaluator", None)
    monkeypatch.setattr("crosstrace.harness.flip.find_spec", lambda name: None)
    assert flip(np.zeros((4, 4, 3)), np.zeros((4, 4, 3))) is None


@pytest.mark.skipif(find_spec("flip_evaluator") is None, reason="flip-evaluator is not installed")
def test_the_greatest_finds_a_defect_of_one_pixel() -> None:
    """The 99.9th percentile need not; images that are the same differ by 0."""
    image = np.full((200, 200, 3), 0.25)
    assert flip(image, image) == {"max": 0.0, "p999": 0.0}
    other = image.copy()
    other[20, 20] = 1.0
    found = flip(image, other)
    assert found is not None and found["max"] > 0.3 and found["p999"] < found["max"] / 2
    other[0, 0] = np.nan
    assert flip(image, other) is None
