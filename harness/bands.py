"""Large images in bands of rows, so that no one has to hold a whole one.

How an image is cut depends on its shape alone. What is summed up over bands is hence the same to
the last bit whether the image lies in memory or in a file; one of up to `PIXELS` pixels is one
band.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

#: In a band, but for an image so wide that `FEWEST_ROWS` are more.
PIXELS = 2**21
FEWEST_ROWS = 16


class Rows(Protocol):
    """An image that is read from the top to the bottom."""

    shape: tuple[int, int, int]

    def next(self, count: int) -> Array:
        """Return the next rows, (count, columns, 3) float64, linear."""


class RowsInMemory:
    """An array as `Rows`."""

    def __init__(self, image: Array) -> None:
        """Take (rows, columns, 3)."""
        self.shape: tuple[int, int, int] = image.shape
        self._image = image
        self._row = 0

    def next(self, count: int) -> Array:
        """Return a view of the next rows."""
        begin, self._row = self._row, self._row + count
        return self._image[begin : self._row]


def is_large(rows: int, columns: int) -> bool:
    """Whether an image is more than one band."""
    return rows * columns > PIXELS


def cut(rows: int, columns: int) -> Iterator[tuple[int, int]]:
    """Yield the first row and the row after the last of every band, from the top."""
    height = rows
    if is_large(rows, columns):
        height = max(FEWEST_ROWS, PIXELS // columns)
    for begin in range(0, rows, max(1, height)):
        yield begin, min(rows, begin + height)


def side_by_side(first: Rows, second: Rows) -> Iterator[tuple[int, Any, Any]]:
    """Yield the first row and both images' bands."""
    rows, columns, _ = first.shape
    for begin, end in cut(rows, columns):
        yield begin, first.next(end - begin), second.next(end - begin)
