"""Rate and time left, by a clock that the test turns."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from crosstrace.harness.pace import Pace, duration, rate


def at(seconds: float, done: float, total: float, counted: bool = True) -> str:
    clock = iter((100.0, 100.0 + seconds))
    return Pace(lambda: next(clock)).text(done, total, counted)


def test_time_left_follows_from_what_is_done() -> None:
    """Ten of forty in five seconds: fifteen more."""
    assert at(5.0, 10, 40) == "2/s, 15 s left"
    assert at(50.0, 10, 40) == "5s each, 2 min 30 s left"
    assert at(3.0, 0.25, 1.0, counted=False) == "9.0 s left"


def test_too_early_nothing_is_foretold() -> None:
    """No step is done, or hardly any time has passed."""
    assert at(5.0, 0.5, 40) == at(0.1, 3, 40) == at(5.0, 0.0, 1.0, counted=False) == ""


def test_in_the_end_the_time_taken_is_told() -> None:
    """Also where it was short."""
    assert at(75.0, 4, 4) == "in 1 min 15 s"
    assert at(0.04, 1.0, 1.0, counted=False) == "in 0.0 s"


@pytest.mark.parametrize(
    ("seconds", "text"),
    [(0.0, "0.0 s"), (9.94, "9.9 s"), (9.96, "10 s"), (59.4, "59 s"), (59.6, "1 min 0 s"),
     (599.7, "10 min"), (3599, "1 h 0 min"), (7500, "2 h 5 min")],
)  # fmt: skip
def test_durations_have_the_units_that_matter(seconds: float, text: str) -> None:
    """No 60 s and no 60 min."""
    assert duration(seconds) == text


@given(st.floats(1e-3, 1e4), st.floats(0, 3.5e5))
def test_words_stay_short(a_second: float, seconds: float) -> None:
    """So that a bar keeps within 80 columns."""
    assert len(rate(a_second)) <= 10
    assert len(duration(seconds)) <= 12
