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

from crosstrace.harness.bands import cut
from crosstrace.harness.display import display_color
from crosstrace.harness.metrics import checked_pair

#: Side of the window in pixels: no smaller image has a similarity.
WINDOW = 11
#: Rows and columns at the edge whose window is not whole.
_BORDER = WINDOW // 2


@dataclass(frozen=True)
class Similarity:
    """`mean` over the image without a border of 5 pixels, `map` (v_res, h_res, 3) float64.

    Both are None where the similarity is undefined: an image too small, or values not finite. The
    map is also None where it was not asked for.
    """

    mean: float | None
    map: NDArray[np.float64] | None


def similarity(a: Any, b: Any) -> Similarity:
    """Compare two linear images (v_res, h_res, 3); raises UsageError on other shapes."""
    first, second = checked_pair(a, b)
    tally = Tally(first.shape, keeps_map=True)
    for begin, end in cut(*first.shape[:2]):
        tally.add(first[begin:end], second[begin:end])
    return tally.similarity()


class Tally:
    """The similarity of two images that come in the bands of `bands.cut`, from the top.

    A row's similarity needs `_BORDER` rows on each side: those of a band's end wait for the next.
    """

    def __init__(self, shape: tuple[int, ...], *, keeps_map: bool = False) -> None:
        """Start at the first row of images of that shape."""
        self._rows, self._columns = shape[:2]
        self._map = np.ones((self._rows, self._columns, 3)) if keeps_map else None
        self._is_defined = min(shape[:2]) >= WINDOW
        self._is_identical = True
        self._done = self._first_held = self._next = 0
        self._held: list[NDArray[np.float64]] = [np.empty((0, self._columns, 3))] * 2
        self._sums = np.zeros(3)

    def add(self, a: NDArray[np.float64], b: NDArray[np.float64]) -> None:
        """Add the next rows of both images."""
        self._next += len(a)
        if not (self._is_defined and np.isfinite(a).all() and np.isfinite(b).all()):
            self._is_defined = False
            return
        self._is_identical = self._is_identical and np.array_equal(a, b)
        held = [
            np.concatenate([old, new]) if len(old) else new
            for old, new in zip(self._held, (a, b), strict=True)
        ]
        end = self._next if self._next == self._rows else self._next - _BORDER
        if end > self._done:
            self._take(held, end)
        kept = max(0, self._done - _BORDER - self._first_held)
        self._first_held += kept
        self._held = [image[kept:].copy() for image in held]

    def similarity(self) -> Similarity:
        """Return what all bands together say."""
        if not self._is_defined:
            return Similarity(None, None)
        if self._is_identical:
            return Similarity(1.0, self._map)
        inner = (self._rows - 2 * _BORDER) * (self._columns - 2 * _BORDER)
        mean = float((self._sums / inner).mean())
        return Similarity(mean if math.isfinite(mean) else None, self._map)

    def _take(self, held: list[NDArray[np.float64]], end: int) -> None:
        """Work out the rows up to `end`."""
        a, b = held
        full = np.ones_like(a) if np.array_equal(a, b) else _map_of(a, b)
        rows = full[self._done - self._first_held : end - self._first_held]
        if self._map is not None:
            self._map[self._done : end] = rows
        top = max(_BORDER - self._done, 0)
        bottom = min(end, self._rows - _BORDER) - self._done
        if bottom > top:
            for channel in range(3):
                # Contiguous as scikit-image has it, so that the sum is taken in the same order.
                plane = np.ascontiguousarray(rows[..., channel])
                self._sums[channel] += plane[top:bottom, _BORDER:-_BORDER].sum()
        self._done = end


def _map_of(a: NDArray[np.float64], b: NDArray[np.float64]) -> NDArray[np.float64]:
    from skimage.metrics import structural_similarity

    full: NDArray[np.float64] = structural_similarity(
        display_color(a),
        display_color(b),
        data_range=1.0,
        channel_axis=-1,
        gaussian_weights=True,
        sigma=1.5,
        use_sample_covariance=False,
        full=True,
    )[1]
    return full
