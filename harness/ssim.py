"""Structural similarity of two images as a person sees them: on the display colour.

The definition is Wang et al. 2004 with a Gaussian window of σ = 1.5 (11 × 11), population
covariance, a data range of 1 and the mean over the three channels, as scikit-image computes it with
the arguments below. It is undefined below 11 pixels a side.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crosstrace.harness.display import display_color
from crosstrace.harness.metrics import checked_pair

#: Side of the window in pixels: no smaller image has a similarity.
WINDOW = 11


@dataclass(frozen=True)
class Similarity:
    """`mean` over the image without a border of 5 pixels, `map` (v_res, h_res, 3) float64.

    Both are None where the similarity is undefined: an image too small, or values not finite.
    """

    mean: float | None
    map: NDArray[np.float64] | None


def similarity(a: Any, b: Any) -> Similarity:
    """Compare two linear images (v_res, h_res, 3); raises UsageError on other shapes."""
    first, second = checked_pair(a, b)
    if min(first.shape[:2]) < WINDOW:
        return Similarity(None, None)
    if not (np.isfinite(first).all() and np.isfinite(second).all()):
        return Similarity(None, None)
    if np.array_equal(first, second):
        return Similarity(1.0, np.ones_like(first))
    from skimage.metrics import structural_similarity

    mean, full = structural_similarity(
        display_color(first),
        display_color(second),
        data_range=1.0,
        channel_axis=-1,
        gaussian_weights=True,
        sigma=1.5,
        use_sample_covariance=False,
        full=True,
    )
    return Similarity(float(mean) if math.isfinite(mean) else None, full)
