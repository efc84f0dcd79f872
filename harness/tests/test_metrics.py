"""Numbers about two images: by hand, against scikit-image, and what must hold for any two."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import array_shapes, arrays

from crosstrace.harness.metrics import THRESHOLDS, difference, measure
from crosstrace.translators.errors import UsageError

IMAGES = array_shapes(min_dims=2, max_dims=2, max_side=6).flatmap(
    lambda shape: st.tuples(
        *[arrays(np.float64, (*shape, 3), elements=st.floats(-4, 4, width=32))] * 2
    )
)


def test_the_numbers_of_a_small_image_are_those_computed_by_hand() -> None:
    """Six channel values: one differs by 0.3, one by −0.4."""
    a = np.zeros((1, 2, 3))
    b = a.copy()
    a[0, 0, 1], b[0, 1, 2] = 0.3, 0.4
    found = measure(a, b)
    assert found.pixels == 2
    assert found.max == 0.4
    assert found.mean == pytest.approx(0.7 / 6, rel=1e-15)
    assert found.bias == pytest.approx(-0.1 / 6, rel=1e-15)
    assert found.rmse == pytest.approx(math.sqrt(0.25 / 6), rel=1e-15)
    assert found.psnr == pytest.approx(10 * math.log10(6 / 0.25), rel=1e-15)
    assert found.over == {"over_1_255": 2, "over_1e_4": 2, "over_1e_9": 2}
    assert [(w.row, w.col, w.difference) for w in found.worst] == [(0, 1, 0.4), (0, 0, 0.3)]
    assert found.worst[0].b == (0.0, 0.0, 0.4)


def test_the_difference_is_signed() -> None:
    """It is a − b, not its magnitude."""
    a, b = np.zeros((1, 1, 3)), np.full((1, 1, 3), 0.25)
    assert (difference(a, b) == -0.25).all()


def test_numbers_agree_with_scikit_image() -> None:
    """RMSE and PSNR by another program."""
    from skimage.metrics import mean_squared_error, peak_signal_noise_ratio

    rng = np.random.default_rng(7)
    a, b = rng.random((2, 37, 23, 3))
    found = measure(a, b)
    assert found.rmse**2 == pytest.approx(mean_squared_error(a, b), rel=1e-12)
    assert found.psnr == pytest.approx(peak_signal_noise_ratio(a, b, data_range=1.0), rel=1e-12)


@pytest.mark.parametrize("key", THRESHOLDS)
def test_a_pixel_counts_only_beyond_a_threshold_in_any_channel(key: str) -> None:
    """At the threshold itself it does not."""
    limit = THRESHOLDS[key]
    b = np.zeros((1, 3, 3))
    a = b.copy()
    a[0, 0, 2] = limit
    a[0, 1, 2] = -np.nextafter(limit, 1)
    assert measure(a, b).over[key] == 1


def test_identical_images_have_no_psnr_and_no_worst_pixel() -> None:
    """An infinite ratio is not a number for JSON."""
    a = np.random.default_rng(1).random((4, 5, 3))
    found = measure(a, a.copy())
    assert found.identical
    assert (found.max, found.mean, found.rmse, found.psnr) == (0.0, 0.0, 0.0, None)
    assert found.worst == ()


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
def test_what_is_not_finite_is_beyond_everything_and_never_hidden(bad: float) -> None:
    """A single such value leaves no finite maximum, mean or RMSE behind which it could hide."""
    a = np.zeros((3, 3, 3))
    b = a.copy()
    b[1, 2, 0] = bad
    found = measure(a, b)
    assert set(found.over.values()) == {1}
    assert (found.nonfinite, found.differing) == (1, 1)
    assert not math.isfinite(found.max)
    assert not math.isfinite(found.mean)
    assert not math.isfinite(found.rmse)
    assert found.psnr is None
    assert (found.worst[0].row, found.worst[0].col) == (1, 2)


def test_two_pixels_that_are_both_undefined_do_not_agree() -> None:
    """NaN equals nothing, itself included."""
    a = np.full((2, 2, 3), np.nan)
    assert measure(a, a.copy()).over["over_1e_9"] == 4


def test_the_worst_pixels_are_sorted_and_ties_come_in_reading_order() -> None:
    """The same image lists the same pixels on every machine."""
    a = np.zeros((5, 5, 3))
    a[1:4, 1:4, 0] = 0.5
    a[4, 4, 1] = 0.75
    found = measure(a, np.zeros_like(a), n_worst=4)
    assert [(w.row, w.col) for w in found.worst] == [(4, 4), (1, 1), (1, 2), (1, 3)]


@pytest.mark.parametrize("scale", [1e-200, 1e200])
def test_tiny_and_huge_differences_keep_their_root_mean_square(scale: float) -> None:
    """Their squares leave the range of double, their mean square's root does not."""
    a = np.full((2, 2, 3), scale)
    assert measure(a, np.zeros_like(a)).rmse == pytest.approx(scale, rel=1e-15)


@pytest.mark.parametrize(
    ("a", "b"), [((2, 3, 3), (3, 2, 3)), ((2, 3), (2, 3)), ((2, 3, 4), (2, 3, 4))]
)
def test_images_of_other_shapes_are_refused(a: tuple[int, ...], b: tuple[int, ...]) -> None:
    """Nothing is cut or repeated to make them fit."""
    with pytest.raises(UsageError, match="expected"):
        measure(np.zeros(a), np.zeros(b))


@settings(deadline=None)
@given(IMAGES)
def test_metrics_are_symmetric_but_for_the_sign(pair: tuple[np.ndarray, np.ndarray]) -> None:
    """Which image comes first changes the bias alone."""
    a, b = pair
    there, back = measure(a, b), measure(b, a)
    assert there.bias == -back.bias
    for name in ("max", "mean", "rmse", "psnr", "over", "differing", "nonfinite", "pixels"):
        assert getattr(there, name) == getattr(back, name)


@settings(deadline=None)
@given(IMAGES)
def test_metrics_keep_their_order(pair: tuple[np.ndarray, np.ndarray]) -> None:
    """|bias| ≤ mean ≤ RMSE ≤ max, and counts fall as thresholds rise."""
    found = measure(*pair)
    slack = 1 + 1e-12
    assert abs(found.bias) <= found.mean * slack
    assert found.mean <= found.rmse * slack
    assert found.rmse <= found.max * slack
    over = found.over
    assert over["over_1_255"] <= over["over_1e_4"] <= over["over_1e_9"] <= found.differing
    assert found.identical == np.array_equal(*pair)
