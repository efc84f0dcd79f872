"""Portable float maps, read and written here: the image library returns them upside down.

The format: `PF` (three channels) or `Pf` (one), width and height, a scale whose sign is the byte
order (negative: little-endian), one white space, then float32 rows from the bottom to the top.
"""

from __future__ import annotations

import contextlib
import math
import re
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crosstrace.translators.errors import UsageError

_HEADER = re.compile(rb"(P[Ff])\s+(\d{1,9})\s+(\d{1,9})\s+([-+.\deE]{1,32})\s")


@contextlib.contextmanager
def reading(path: Path) -> Iterator[Any]:
    """Open a map; gives its shape, what reads rows [begin, end), row 0 at the top, and no metadata.

    A grey one is repeated thrice. The magnitude of the scale is ignored, as by every program of the
    field. Raises UsageError for a file that is not a whole portable float map.
    """
    with path.open("rb") as file:
        match = _HEADER.match(file.read(128))
        try:
            scale = float(match[4]) if match else math.nan
        except ValueError:
            scale = math.nan
        if match is None or not math.isfinite(scale) or scale == 0:
            raise UsageError(f"{path}: expected a portable float map, found another header")
        channels = 3 if match[1] == b"PF" else 1
        width, height, start = int(match[2]), int(match[3]), match.end()
        row_bytes = width * channels * 4
        expected, found = row_bytes * height, path.stat().st_size - start
        if found != expected or not expected:
            raise UsageError(f"{path}: expected {expected} bytes of pixels, found {found}")
        dtype = "<f4" if scale < 0 else ">f4"

        def read_rows(begin: int, end: int) -> NDArray[np.float64]:
            file.seek(start + (height - end) * row_bytes)
            data = file.read((end - begin) * row_bytes)
            upright = np.frombuffer(data, dtype).reshape(end - begin, width, channels)[::-1]
            whole = np.broadcast_to(upright.astype(np.float64), (end - begin, width, 3))
            return np.ascontiguousarray(whole)

        yield (height, width, 3), read_rows, {}


def read(path: Path) -> NDArray[np.float64]:
    """Read a map as (rows, columns, 3); see `reading`."""
    with reading(path) as (shape, read_rows, _):
        rows: NDArray[np.float64] = read_rows(0, shape[0])
        return rows


@contextlib.contextmanager
def writing(
    path: Path, shape: tuple[int, ...]
) -> Iterator[Callable[[NDArray[np.floating[Any]]], None]]:
    """Open a file for float32, little-endian; rows are given from the top."""
    with path.open("wb") as file:
        file.write(f"PF\n{shape[1]} {shape[0]}\n-1.0\n".encode("ascii"))
        start, left = file.tell(), shape[0]

        def write_rows(rows: NDArray[np.floating[Any]]) -> None:
            nonlocal left
            left -= len(rows)
            file.seek(start + left * shape[1] * 12)
            file.write(rows[::-1].astype("<f4").tobytes())

        yield write_rows


def write(path: Path, image: NDArray[np.floating[Any]]) -> None:
    """Write a linear image (rows, columns, 3) as float32, little-endian."""
    with writing(path, image.shape) as write_rows:
        write_rows(image)
