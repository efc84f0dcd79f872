"""Structural similarity: the definition that was fixed, and where it does not exist."""

from __future__ import annotations

import numpy as np
import pytest
from skimage.metrics import structural_similarity

from crosstrace.harness.ssim import similarity


def _pair(rows: int, columns: int, peak: float = 1.0) -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(3)
    a = rng.random((rows, columns, 3)) * peak
    return a, np.clip(a + rng.normal(0, 0.05, a.shape), 0, peak)


def test_similarity_is_that_of_scikit_image_with_the_fixed_arguments() -> None:
    """Wang et al.: a Gaussian window of σ 1.5, population covariance, range 1."""
    a, b = _pair(40, 30)
    mean, full = structural_similarity(
        a, b, data_range=1.0, channel_axis=-1, gaussian_weights=True, sigma=1.5,
        use_sample_covariance=False, full=True,
    )  # fmt: skip
    found = similarity(a, b)
    assert found.mean == mean
    assert found.map is not None
    assert np.array_equal(found.map, full)


def test_similarity_is_taken_on_the_display_colour() -> None:
    """A colour beyond 1 is divided by its largest component before it is compared."""
    a, b = _pair(20, 20, peak=4.0)
    shown = [image / np.maximum(image.max(axis=2, keepdims=True), 1) for image in (a, b)]
    assert similarity(a, b).mean == similarity(*shown).mean


def test_identical_images_have_a_similarity_of_exactly_one() -> None:
    """Not one less some rounding."""
    a, _ = _pair(20, 20)
    found = similarity(a, a.copy())
    assert found.mean == 1.0
    assert found.map is not None
    assert (found.map == 1.0).all()


@pytest.mark.parametrize("shape", [(10, 40), (40, 10), (1, 1)])
def test_there_is_no_similarity_below_eleven_pixels_a_side(shape: tuple[int, int]) -> None:
    """Also of identical images: null is not a pass."""
    a, b = _pair(*shape)
    assert similarity(a, b).mean is None
    assert similarity(a, a).mean is None


def test_eleven_pixels_are_enough() -> None:
    """The window is 11 wide."""
    assert similarity(*_pair(11, 11)).mean is not None


def test_there_is_no_similarity_of_values_that_are_not_finite() -> None:
    """One NaN would spread over the window; the metrics report it instead."""
    a, b = _pair(20, 20)
    b[3, 3, 0] = np.nan
    assert similarity(a, b).mean is None
    assert similarity(b, b).mean is None
