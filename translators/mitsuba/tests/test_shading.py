"""The shading functions on Dr.Jit arrays, against arithmetic with more digits."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

Wide = NDArray[np.longdouble]


@pytest.fixture(autouse=True)
def ready(works: None) -> None:
    """Set the variant."""
    from crosstrace.translators.mitsuba import runtime

    runtime.start(0)


def directions(count: int, spread: float) -> tuple[Wide, Wide]:
    """Return unit vectors and others at up to `spread` radians from them, (count, 3)."""
    rng = np.random.default_rng(7)
    a = rng.normal(size=(count, 3)).astype(np.longdouble)
    a /= np.sqrt((a * a).sum(axis=1))[:, None]
    b = a + spread * rng.uniform(-1, 1, size=(count, 3))
    return a, b / np.sqrt((b * b).sum(axis=1))[:, None]


@pytest.mark.parametrize("exponent", [1.0, 2.0, 7.3, 50.0, 2000.0, 9999.5, 1e4, 1e6])
def test_powers_of_cosines_keep_their_digits(exponent: float) -> None:
    """Up to an exponent of a million the error is a few units of 2^-53 of the highlight's peak."""
    import mitsuba as mi

    from crosstrace.translators.mitsuba import shading

    a, b = directions(2000, min(1.0, 3 / np.sqrt(exponent)))
    a64, b64 = a.astype(float), b.astype(float)
    found = shading.power_of_cosine(
        mi.Vector3d(a64.T.copy()), mi.Vector3d(b64.T.copy()), mi.Float64(exponent)
    )
    # The rounding of a and b themselves is not the function's: |a − b|² is taken of what it got.
    h = ((a64.astype(np.longdouble) - b64) ** 2).sum(axis=1) / 2
    expected = np.where(h < 1, np.exp(exponent * np.log1p(-np.minimum(h, 0.999999))), 0)
    shown = np.where((a64 * b64).sum(axis=1) > 1e-3, np.abs(np.array(found) - expected), 0)
    assert float(shown.max()) <= max(1.0, exponent / 1e3) * 2e-15


def test_highlights_too_small_for_a_number_are_black() -> None:
    """Neither NaN nor infinity comes out of a cosine near 0 or a huge exponent."""
    import mitsuba as mi

    from crosstrace.translators.mitsuba import shading

    one = mi.Vector3d([1.0] * 4, [0.0] * 4, [0.0] * 4)
    other = mi.Vector3d([1e-300, 0.0, -1.0, 0.5], [1.0, 1.0, 0.0, 0.75**0.5], [0.0] * 4)
    assert np.array_equal(shading.power_of_cosine(one, other, mi.Float64(1e6)), [0, 0, 0, 0])


@pytest.mark.parametrize("index", [0.7, 1.0, 1.4, 2.5])
def test_refraction_follows_snell(index: float) -> None:
    """sin θo = n sin θi on both sides; total reflection exactly where the sine would exceed 1."""
    import mitsuba as mi

    from crosstrace.translators.mitsuba import shading

    angle = np.linspace(0.01, np.pi - 0.01, 999)
    angle = angle[np.abs(np.cos(angle)) > 1e-3]
    bent = shading.bend(mi.Float64(np.cos(angle)), mi.Float64(index))
    m, delta, along = (np.array(x) for x in bent)
    wo = np.stack([np.sin(angle), np.cos(angle)])
    t = -m * wo - along * np.array([[0.0], [1.0]])
    ratio = np.where(np.cos(angle) > 0, 1 / index, index)
    sine = ratio * np.sin(angle)
    passes = sine < 1
    assert np.array_equal(delta >= 0, passes)
    assert np.abs(np.hypot(*t)[passes] - 1).max() <= 1e-14
    assert np.abs(-t[0][passes] - sine[passes]).max() <= 1e-14
    assert (np.sign(t[1][passes]) == -np.sign(np.cos(angle[passes]))).all()
