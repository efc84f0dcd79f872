"""POV-Ray's 16-bit output: reading it, and the scale K that keeps values beyond 1.

A sample is ``floor(65535·v + 0.5)`` of a value cut to 0…1 (`encoding.h` of 3.7), with File_Gamma 1
and no dithering: linear, half a step 7.63e-6·K wide. K begins with the bound that follows from the
scene's numbers, or with 2 where that is larger: the bound counts every light as unblocked and every
bounce as bright, while images seldom exceed 2, and a second run of the program costs more than a
bit of precision. What is saturated all the same is rendered again at a larger K, everything else
keeps its finer step. So K comes from the scene and from POV-Ray alone.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from crosstrace.translators.errors import RendererError
from crosstrace.translators.povray.plan import Array
from crosstrace.translators.renderer import Progress

WHITE = 65535

#: Room for POV-Ray's float32 above a bound computed in double.
_MARGIN = 1 + 1e-5

#: The largest K to begin with, and what it is multiplied by while something saturates.
_FIRST = 2.0
_GROWTH = 4.0

#: The largest K of a written scene: at 16, half a step passes 1e-4, so that a larger one would
#: spoil every pixel for the sake of values that hardly occur.
_LARGEST_WRITTEN = 16.0

_HEADER = re.compile(rb"P6\s+((?:#[^\n]*\s+)*)(\d+)\s+(\d+)\s+(\d+)\s")
_VERSION = re.compile(rb"POV-Ray (\d+(?:\.\d+)+)")


@dataclass(frozen=True)
class Picture:
    """One image file: samples (rows, columns, 3) uint16 and the POV-Ray version it names."""

    samples: np.ndarray[tuple[int, ...], np.dtype[np.uint16]]
    version: str


@dataclass(frozen=True)
class Scaled:
    """An image put together from one rendering or more: linear float64, and the largest K."""

    image: Array
    scale: float
    passes: tuple[float, ...]
    version: str

    @property
    def half_step(self) -> float:
        """Half a step of the coarsest samples."""
        return self.scale / (2 * WHITE)


def safe_scale(bound: float) -> float:
    """Return a K, 1 at least, at which no pixel of a scene bounded so can saturate."""
    return 1.0 if bound <= 1 else _short(bound * _MARGIN)


def written_scale(bound: float) -> float:
    """Return the K of a scene that is written for others to render: no second run can mend it."""
    return min(safe_scale(bound), _LARGEST_WRITTEN)


def render_scaled(
    render: Callable[[float], Picture], bound: float, first: float | None = None
) -> Scaled:
    """Render at growing K until nothing saturates that could be brighter.

    `render` gives the picture at one K; `bound` is a number that no pixel exceeds. `first` is the K
    to begin with.
    """
    scale = min(safe_scale(bound), _FIRST) if first is None else _short(first)
    picture = render(scale)
    image = picture.samples.astype(np.float64) * (scale / WHITE)
    passes = [scale]
    saturated = picture.samples == WHITE
    while scale < bound and saturated.any():
        scale = min(_short(_GROWTH * scale), safe_scale(bound))
        picture = render(scale)
        passes.append(scale)
        image[saturated] = picture.samples[saturated] * (scale / WHITE)
        saturated &= picture.samples == WHITE
    return Scaled(image, passes[-1], tuple(passes), picture.version)


def _short(scale: float) -> float:
    """Round up to three digits: POV-Ray keeps six of a number declared on its command line."""
    step = 10.0 ** (math.floor(math.log10(scale)) - 2)
    return float(f"{math.ceil(scale / step) * step:.4g}")


def shared(progress: Progress | None, bound: float, passes: int) -> Progress | None:
    """Return the progress of one pass, after `passes` others, as a part of the whole.

    Where more passes may follow, each takes half of what is left.
    """
    if progress is None or bound <= _FIRST:
        return progress
    done, share, whole = 1 - 0.5**passes, 0.5 ** (passes + 1), progress
    return lambda fraction: whole(done + share * fraction)


def read_ppm(path: Path, v_res: int, h_res: int) -> Picture:
    """Read a binary 16-bit PPM of a known size; raises RendererError where it is not one."""
    if not path.is_file():
        raise RendererError("povray ended without writing an image")
    raw = path.read_bytes()
    header = _HEADER.match(raw)
    if header is None:
        raise RendererError("povray wrote no PPM image")
    width, height, white = (int(group) for group in header.groups()[1:])
    if (width, height, white) != (h_res, v_res, WHITE):
        raise RendererError(
            f"povray wrote an image of {width}×{height} with maximum {white}, "
            f"expected {h_res}×{v_res} with {WHITE}"
        )
    body = raw[header.end() :]
    if len(body) != 6 * width * height:
        raise RendererError(
            f"povray wrote {len(body)} bytes of pixels, expected {6 * width * height}"
        )
    version = _VERSION.search(header[1])
    samples = np.frombuffer(body, ">u2").astype(np.uint16).reshape(height, width, 3)
    return Picture(samples, version[1].decode() if version else "")
