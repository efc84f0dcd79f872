"""Portable float maps, read and written here: the image library returns them upside down.

The format: `PF` (three channels) or `Pf` (one), width and height, a scale whose sign is the byte
order (negative: little-endian), one white space, then float32 rows from the bottom to the top.
"""

from __future__ import annotations

import math
import re
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crosstrace.translators.errors import UsageError

_HEADER = re.compile(rb"(P[Ff])\s+(\d{1,9})\s+(\d{1,9})\s+([-+.\deE]{1,32})\s")


def read(path: Path) -> NDArray[np.float64]:
    """Read a map as (rows, columns, 3), row 0 at the top; a grey one is repeated thrice.

    The magnitude of the scale is ignored, as by every program of the field. Raises UsageError for
    a file that is not a whole portable float map.
    """
    data = path.read_bytes()
    match = _HEADER.match(data)
    try:
        scale = float(match[4]) if match else math.nan
    except ValueError:
        scale = math.nan
    if match is None or not math.isfinite(scale) or scale == 0:
        raise UsageError(f"{path}: expected a portable float map, found another header")
    channels = 3 if match[1] == b"PF" else 1
    width, height = int(match[2]), int(match[3])
    expected, found = width * height * channels * 4, len(data) - match.end()
    if found != expected or not expected:
        raise UsageError(f"{path}: expected {expected} bytes of pixels, found {found}")
    dtype = "<f4" if scale < 0 else ">f4"
    pixels = np.frombuffer(data, dtype, offset=match.end()).reshape(height, width, channels)
    upright = pixels[::-1].astype(np.float64)
    return np.ascontiguousarray(np.broadcast_to(upright, (height, width, 3)))


def write(path: Path, image: NDArray[np.floating[Any]]) -> None:
    """Write a linear image (rows, columns, 3) as float32, little-endian."""
    header = f"PF\n{image.shape[1]} {image.shape[0]}\n-1.0\n".encode("ascii")
    path.write_bytes(header + image[::-1].astype("<f4").tobytes())
