"""The 8-bit rule: overflow, truncation, guard, and the readings that change it."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from crosstrace.harness.display import DisplayRule, display_color, to_8bit
from crosstrace.translators.errors import UsageError


def _levels(*color: float, rule: DisplayRule | None = None) -> list[int]:
    levels: list[int] = to_8bit(np.array([[color]], np.float64), rule)[0, 0].tolist()
    return levels


def test_colours_are_truncated_not_rounded() -> None:
    """int(255·v): 0.999 is level 254."""
    assert _levels(0.0, 0.5, 0.999) == [0, 127, 254]
    assert _levels(0.0, 0.5, 0.999, rule=DisplayRule(quantise="round")) == [0, 128, 255]


@given(st.integers(0, 255), st.sampled_from([np.float64, np.float32]))
def test_a_level_written_as_a_fraction_comes_back_as_itself(level: int, kind: type) -> None:
    """The guard of each arithmetic keeps exact colours from falling one level."""
    image = np.full((1, 1, 3), kind(level) / kind(255))
    assert to_8bit(image)[0, 0].tolist() == [level] * 3
    assert to_8bit(image.astype(np.float64))[0, 0].tolist() == [level] * 3


def test_the_guard_of_double_is_a_billionth_of_a_level() -> None:
    """A value two billionths below a level stays below it, half a billionth does not."""
    assert _levels((7 - 2e-9) / 255, (7 - 5e-10) / 255, 0.1) == [6, 7, 25]


def test_a_colour_beyond_one_is_divided_by_its_largest_component() -> None:
    """Its hue stays; clamping, the other reading, changes it."""
    assert _levels(2.0, 1.0, 0.5) == [255, 127, 63]
    assert _levels(2.0, 1.0, 0.5, rule=DisplayRule(overflow="clamp")) == [255, 255, 127]


def test_colours_within_one_are_left_alone() -> None:
    """To the last bit, in an array of its own."""
    image = np.random.default_rng(5).random((3, 4, 3))
    shown = display_color(image)
    assert np.array_equal(shown, image)
    assert shown is not image


def test_negative_and_undefined_values_become_zero() -> None:
    """An 8-bit file cannot say more; the record counts what is not finite."""
    assert _levels(-0.5, np.nan, 0.25) == [0, 0, 63]
    assert _levels(np.nan, 4.0, 2.0) == [0, 255, 127]
    assert _levels(np.inf, 1.0, 0.0) == [0, 0, 0]


def test_display_readings_are_taken_out_of_the_others() -> None:
    """What is left goes to the renderer."""
    rule, left = DisplayRule.split({"overflow": "clamp", "mix": "convex"})
    assert rule == DisplayRule(overflow="clamp")
    assert left == {"mix": "convex"}
    with pytest.raises(UsageError, match=r"overflow=wrap: expected scale\|clamp, found wrap"):
        DisplayRule.split({"overflow": "wrap"})
