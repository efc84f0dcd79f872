"""Maps of a byte a pixel: their steps, signs and special values."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from crosstrace.harness import maps


def pair(*differences: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return two images of one row, the second different by so much in its green channel."""
    a = np.zeros((1, len(differences), 3))
    b = a.copy()
    b[0, :, 1] = differences
    return a, b


@given(exponent=st.floats(-17.9, 12.9), negative=st.booleans())
def test_a_step_holds_its_difference(exponent: float, negative: bool) -> None:
    """Between its lower end and a quarter of a decade more, with the sign of b − a."""
    size = 10.0**exponent
    code = int(maps.difference(*pair(-size if negative else size))[0, 0])
    assert (code > maps.MOST) == negative
    step = code - (maps.MOST if negative else 0)
    low = maps.LEAST_DIFFERENCE + (step - 1) / maps.STEPS
    assert low - 1e-9 <= exponent <= low + 1 / maps.STEPS + 1e-9


def test_nothing_and_what_is_no_number_have_bytes_of_their_own() -> None:
    """0 is the same to the last bit, and one undefined channel is enough."""
    a, b = pair(0.0, np.nan, np.inf, 5e-324, 1e300)
    assert maps.difference(a, b)[0].tolist() == [0, 255, 255, 1, 126]
    a[0, 0] = b[0, 0] = np.nan
    assert maps.difference(a, b)[0, 0] == 255


@pytest.mark.parametrize(
    ("off", "digits"), [(0, 17), (1e-20, 16), (2e-3, 2), (1e-3, 3), (1.0, 0), (50.0, 0)]
)
def test_digits_are_those_that_agree(off: float, digits: int) -> None:
    """A difference of 2 in a thousand leaves two, one of more than the value none."""
    a = np.full((1, 1, 3), 1.0)
    b = a.copy()
    b[0, 0, 2] += off
    # 1 + 1e-20 is 1: give the difference where it can be held.
    if off == 1e-20:
        a[..., 2] = 0.0
        b[..., 2] = off
    expected = digits
    assert maps.digits(a, b)[0, 0] == expected


def test_digits_of_black_and_of_no_number() -> None:
    """Against 0 nothing agrees unless all does."""
    a, b = pair(0.0, 1e-9, np.nan)
    assert maps.digits(a, b)[0].tolist() == [17, 0, 255]


def test_unlikeness_has_a_floor_and_steps() -> None:
    """Rounding of the window's sums is nothing; 0.99 and 0 are eight steps a two decades apart."""
    similarity = np.ones((1, 4, 3)) * np.array([1 + 1e-15, 1 - 1e-10, 0.985, -0.5])[None, :, None]
    none, rounding, little, all_ = maps.unlike(similarity)[0].tolist()
    assert (none, rounding) == (0, 0)
    assert 0 < little < all_ <= 38


def test_maps_come_back_from_their_file(tmp_path: Path) -> None:
    """By their names."""
    written = {"difference": np.arange(6, dtype=np.uint8).reshape(2, 3)}
    maps.write(tmp_path / "x.npz", written)
    assert np.array_equal(maps.read(tmp_path / "x.npz")["difference"], written["difference"])
