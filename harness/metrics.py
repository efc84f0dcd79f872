"""Numbers about two images of one scene, on linear float: they inform, they do not decide.

All are over the differences a − b of images (v_res, h_res, 3). A pixel counts as beyond a threshold
when any of its channels is, and a difference that is not a number is beyond every threshold. Where
a pixel's difference is not finite, so are max, mean, RMSE and PSNR: nothing is left out of them.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crosstrace.harness.bands import cut
from crosstrace.translators.errors import UsageError

Array = NDArray[np.float64]

#: Key of the record → threshold on linear float.
THRESHOLDS = {"over_1_255": 1 / 255, "over_1e_4": 1e-4, "over_1e_9": 1e-9}

#: How many of the worst pixels are listed.
N_WORST = 8


@dataclass(frozen=True)
class WorstPixel:
    """One pixel: row and column from 0 at the top left, greatest difference, both colours."""

    row: int
    col: int
    difference: float
    a: tuple[float, float, float]
    b: tuple[float, float, float]


@dataclass(frozen=True)
class Metrics:
    """Differences of two images.

    `pixels` is v_res·h_res; `max` and `mean` are of |a − b| over all channel values, `bias` is the
    mean of a − b, `psnr` is −20·log10(rmse) in dB for a peak of 1 and None where nothing differs.
    `over` counts the pixels beyond each of `THRESHOLDS`, `differing` those not equal to the last
    bit, `nonfinite` those whose difference is not finite. `worst` lists the most different pixels,
    the greatest first and equal ones in reading order; pixels that agree are never listed.
    """

    pixels: int
    max: float
    mean: float
    bias: float
    rmse: float
    psnr: float | None
    over: dict[str, int]
    differing: int
    nonfinite: int
    worst: tuple[WorstPixel, ...]

    @property
    def identical(self) -> bool:
        """Whether no pixel differs at all."""
        return self.differing == 0


def checked_pair(a: Any, b: Any) -> tuple[Array, Array]:
    """Return both images as (v_res, h_res, 3) float64; raises UsageError where they don't match."""
    first, second = np.asarray(a, np.float64), np.asarray(b, np.float64)
    for image in (first, second):
        if image.ndim != 3 or image.shape[2] != 3:
            raise UsageError(f"expected an image of shape (rows, columns, 3), found {image.shape}")
    if first.shape != second.shape:
        sizes = " and ".join(f"{image.shape[0]}x{image.shape[1]}" for image in (first, second))
        raise UsageError(f"expected two images of one size, found {sizes} (rows x columns)")
    return first, second


def difference(a: Any, b: Any) -> Array:
    """Return the signed difference a − b, (v_res, h_res, 3)."""
    first, second = checked_pair(a, b)
    with np.errstate(invalid="ignore"):
        return first - second


def pixel_difference(signed: Array) -> Array:
    """Return each pixel's greatest absolute difference, (v_res, h_res); NaN where any is NaN."""
    magnitude = np.abs(signed)
    return np.maximum(np.maximum(magnitude[..., 0], magnitude[..., 1]), magnitude[..., 2])


def measure(a: Any, b: Any, n_worst: int = N_WORST) -> Metrics:
    """Compare two images (v_res, h_res, 3) on linear float; raises UsageError on other shapes."""
    first, second = checked_pair(a, b)
    tally = Tally(n_worst)
    for begin, end in cut(*first.shape[:2]):
        tally.add(begin, first[begin:end], second[begin:end])
    return tally.metrics()


class Tally:
    """Metrics of two images that come in the bands of `bands.cut`."""

    def __init__(self, n_worst: int = N_WORST) -> None:
        """Start with nothing."""
        self._n_worst = n_worst
        self._pixels = self._differing = self._nonfinite = 0
        self._over = dict.fromkeys(THRESHOLDS, 0)
        self._max = self._magnitudes = self._differences = 0.0
        self._squares: list[tuple[float, float]] = []
        self._worst: list[WorstPixel] = []

    def add(self, row: int, first: Array, second: Array) -> None:
        """Add a band of both images, (rows, columns, 3), whose first row is `row`."""
        signed = difference(first, second)
        per_pixel = pixel_difference(signed)
        self._pixels += per_pixel.size
        self._max = float(np.maximum(self._max, per_pixel.max(initial=0.0)))
        with np.errstate(invalid="ignore", over="ignore"):
            self._magnitudes += float(np.abs(signed).sum())
            self._squares.append(_squares(signed))
        self._differences += float(signed.sum())
        for key, limit in THRESHOLDS.items():
            self._over[key] += _count_beyond(per_pixel, limit)
        self._differing += _count_beyond(per_pixel, 0.0)
        self._nonfinite += int(np.count_nonzero(~np.isfinite(per_pixel)))
        found = _worst(first, second, per_pixel, self._n_worst)
        self._worst += [replace(pixel, row=pixel.row + row) for pixel in found]
        # Stable, so that of equal ones those that came first stay first.
        self._worst.sort(key=lambda pixel: -_rank(pixel.difference))
        del self._worst[self._n_worst :]

    def metrics(self) -> Metrics:
        """Return the numbers of all that was added."""
        values = 3 * self._pixels
        rmse = _root_mean(self._squares, values)
        return Metrics(
            pixels=self._pixels,
            max=self._max,
            mean=self._magnitudes / values if values else 0.0,
            bias=self._differences / values if values else 0.0,
            rmse=rmse,
            psnr=-20 * math.log10(rmse) if rmse > 0 and math.isfinite(rmse) else None,
            over=dict(self._over),
            differing=self._differing,
            nonfinite=self._nonfinite,
            worst=tuple(self._worst),
        )


def _rank(difference: float) -> float:
    return math.inf if math.isnan(difference) else difference


def _squares(signed: Array) -> tuple[float, float]:
    """Return a scale, and the sum of squares in its units, which neither vanish nor burst."""
    scale = float(np.abs(signed).max(initial=0.0))
    if scale == 0.0 or not math.isfinite(scale):
        return scale, 0.0
    scaled = (signed / scale).ravel()
    return scale, float(scaled @ scaled)


def _root_mean(squares: list[tuple[float, float]], count: int) -> float:
    scale = float(np.max([part[0] for part in squares], initial=0.0))
    if scale == 0.0 or not math.isfinite(scale):
        return scale
    total = sum(found * (own / scale) ** 2 for own, found in squares)
    return scale * math.sqrt(total / count)


def _count_beyond(per_pixel: Array, limit: float) -> int:
    # Counted as "not within", so that NaN is beyond.
    return int(per_pixel.size - np.count_nonzero(per_pixel <= limit))


def _worst(a: Array, b: Array, per_pixel: Array, count: int) -> tuple[WorstPixel, ...]:
    flat = np.where(np.isnan(per_pixel), np.inf, per_pixel).ravel()
    count = min(count, int(np.count_nonzero(flat)))
    if count <= 0:
        return ()
    least = np.partition(flat, flat.size - count)[flat.size - count]
    above = np.flatnonzero(flat > least)
    # Of the many that may tie at the last place, the first in reading order.
    tied = np.flatnonzero(flat == least)[: count - above.size]
    chosen = np.sort(np.concatenate([above, tied]))
    chosen = chosen[np.argsort(-flat[chosen], kind="stable")]
    rows, cols = np.unravel_index(chosen, per_pixel.shape)
    return tuple(
        WorstPixel(int(r), int(c), float(per_pixel[r, c]), _color(a[r, c]), _color(b[r, c]))
        for r, c in zip(rows, cols, strict=True)
    )


def _color(pixel: Array) -> tuple[float, float, float]:
    return float(pixel[0]), float(pixel[1]), float(pixel[2])
