"""POV-Ray's 16-bit output: reading it, and the scale K that keeps values beyond 1.

A sample is ``floor(65535·v + 0.5)`` of a value cut to 0…1 (`encoding.h` of 3.7), with File_Gamma 1
and no dithering: linear, half a step 7.63e-6 wide. Where the scene's numbers do not rule out values
beyond 1, a first image tells: what it shows saturated is rendered again at a larger K, everything
else keeps its finer step. So K comes from the scene and from POV-Ray alone.
"""

from __future__ import annotations

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

#: With this K a value of exactly 1 stays told apart from a saturated one.
_JUST_BEYOND_ONE = 1 + 2.0**-14

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
    """Return a K at which no pixel of a scene bounded so can saturate: 1 or a power of two."""
    return 1.0 if bound <= 1 else float(2.0 ** np.ceil(np.log2(bound * _MARGIN)))


def first_scale(bound: float, background: float) -> float:
    """Return the K to begin with; `background` is the greatest component, on 0…1."""
    return _JUST_BEYOND_ONE if bound > 1 and background == 1 else 1.0


def render_scaled(render: Callable[[float], Picture], bound: float, background: float) -> Scaled:
    """Render at growing K until nothing saturates that could be brighter.

    `render` gives the picture at one K; `bound` is a number that no pixel exceeds.
    """
    scale = first_scale(bound, background)
    picture = render(scale)
    image = picture.samples.astype(np.float64) * (scale / WHITE)
    passes = [scale]
    saturated = picture.samples == WHITE
    growth = 2.0
    while scale < bound and saturated.any():
        scale = min(2.0 ** np.floor(np.log2(scale)) * growth, safe_scale(bound))
        growth = 4.0
        picture = render(float(scale))
        passes.append(float(scale))
        image[saturated] = picture.samples[saturated] * (scale / WHITE)
        saturated &= picture.samples == WHITE
    return Scaled(image, passes[-1], tuple(passes), picture.version)


def shared(progress: Progress | None, bound: float, passes: int) -> Progress | None:
    """Return the progress of one pass, after `passes` others, as a part of the whole.

    Where more passes may follow, each takes half of what is left.
    """
    if progress is None or bound <= 1:
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
