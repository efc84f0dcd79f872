"""The error of an image in four numbers, whatever it is measured against."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from crosstrace.harness.display import to_8bit
from crosstrace.harness.spread import quantile

Array = NDArray[np.float64]

#: Names of the errors by which points are ordered, and how they are said.
METRICS = {"max": "greatest error", "rmse": "RMSE", "p999": "p99.9 of the error"}


@dataclass(frozen=True)
class Value:
    """What images are compared with: (v_res, h_res, 3) linear, `low` beyond double's digits.

    `counts` (v_res, h_res) says where it is known; other pixels are left out. `exact` says that the
    digits of `low` are known, so that an error below double's rounding means something.
    """

    image: Array
    low: Array | float
    counts: NDArray[np.bool_]
    exact: bool = False


@dataclass(frozen=True)
class Error:
    """Over the pixels that count: of the greatest channel difference, but RMSE over all channels.

    `p999` is a value that occurs: all but one pixel in a thousand are no worse. `wrong_8bit` counts
    the pixels whose 8-bit colour is another. None: no pixel counts.
    """

    max: float | None
    rmse: float | None
    p999: float | None
    wrong_8bit: int | None


def measured(image: Array, low: Array | float, value: Value) -> Error:
    """Measure an image against a value."""
    apart = np.abs((image - value.image) + (low - value.low if value.exact else 0.0))
    apart = apart[value.counts]
    if not apart.size:
        return Error(None, None, None, None)
    differs = (to_8bit(image) != to_8bit(value.image)).any(axis=-1) & value.counts
    return _numbers(apart, int(differs.sum()))


def half_widths(low: Array, high: Array, counts: NDArray[np.bool_]) -> Error:
    """Return how far the truth may be from the middle of each enclosure, of the pixels that count.

    No 8-bit colour is promised.
    """
    apart = ((high - low) / 2)[counts]
    return _numbers(apart, None) if apart.size else Error(None, None, None, None)


def _numbers(apart: Array, wrong: int | None) -> Error:
    worst = apart.max(axis=-1)
    if not np.isfinite(worst).all():
        return Error(None, None, None, wrong)
    # Scaled, so that the squares of float128's errors do not vanish.
    scale = float(worst.max()) or 1.0
    rmse = scale * float(np.sqrt(np.mean((apart / scale) ** 2)))
    return Error(float(worst.max()), rmse, quantile(worst), wrong)
