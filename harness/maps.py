"""Maps of two images, one byte a pixel: what the page draws difference and likeness from.

They are small, so that a page can hold them, and their scales are fixed. Logarithmic ones have four
steps a decade: step m ≥ 1 stands for magnitudes from 10^(LEAST + (m − 1)/4) to a step above it.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crosstrace.harness import images
from crosstrace.translators.channels import largest

STEPS = 4

#: Decade of the first step of a difference, and of 1 − SSIM.
LEAST_DIFFERENCE, LEAST_UNLIKE = -18, -9

#: Greatest step; a difference that is negative has this much more.
MOST = 126

#: The byte of what is not a number.
UNDEFINED = 255

#: Digits that float64 holds: the byte of colours that are the same to the last bit.
ALL_DIGITS = 17


def difference(a: NDArray[np.float64], b: NDArray[np.float64]) -> NDArray[np.uint8]:
    """Return the step of b − a in the channel where it is greatest, (v_res, h_res); 0: none.

    A negative one is `MOST` greater, so that 1…126 are positive and 127…252 negative.
    """
    with np.errstate(invalid="ignore"):
        signed = b - a
    size = np.abs(signed)
    most = np.where(size[..., 1] > size[..., 0], signed[..., 1], signed[..., 0])
    most = np.where(size[..., 2] > np.abs(most), signed[..., 2], most)
    # One undefined channel is enough.
    most[np.isnan(largest(size))] = np.nan
    codes = _steps(np.abs(most), LEAST_DIFFERENCE) + np.where(most < 0, MOST, 0)
    codes[most == 0] = 0
    codes[~np.isfinite(most)] = UNDEFINED
    return codes.astype(np.uint8)


def digits(a: NDArray[np.float64], b: NDArray[np.float64]) -> NDArray[np.uint8]:
    """Return how many leading digits of the colours agree, 0…16, or `ALL_DIGITS`; (v_res, h_res).

    It is the whole part of −log10(max |b − a| / max |a|), both over the channels; 0 where a is 0.
    """
    with np.errstate(invalid="ignore", divide="ignore"):
        off = largest(np.abs(b - a))
        lost = np.floor(-np.log10(off / largest(np.abs(a))))
    codes = np.clip(np.nan_to_num(lost, nan=0.0), 0, ALL_DIGITS - 1)
    codes[off == 0] = ALL_DIGITS
    codes[~np.isfinite(off)] = UNDEFINED
    return np.asarray(codes, np.uint8)


def unlike(similarity: NDArray[np.float64]) -> NDArray[np.uint8]:
    """Return the step of 1 − SSIM, the mean over the channels of a map (v_res, h_res, 3)."""
    off = 1.0 - (similarity[..., 0] + similarity[..., 1] + similarity[..., 2]) / 3
    codes = _steps(np.maximum(off, 0.0), LEAST_UNLIKE)
    # As in `colormap.similarity_picture`: what the rounding of the window's sums makes is nothing.
    codes[off <= 10.0**LEAST_UNLIKE] = 0
    return codes.astype(np.uint8)


def _steps(magnitude: NDArray[np.float64], least: int) -> NDArray[np.int64]:
    with np.errstate(divide="ignore", invalid="ignore"):
        steps = np.floor(STEPS * (np.log10(magnitude) - least)) + 1
    whole = np.nan_to_num(steps, nan=1, posinf=MOST, neginf=1)
    return np.asarray(np.clip(whole, 1, MOST), np.int64)


def write(path: Path, maps: dict[str, NDArray[Any]]) -> None:
    """Write maps to a compressed `.npz`, all of it or nothing."""
    images.write_arrays(path, maps)


def read(path: Path) -> dict[str, NDArray[Any]]:
    """Read what `write` wrote; raises OSError or ValueError for anything else."""
    with np.load(path, allow_pickle=False) as loaded:
        return {name: loaded[name] for name in loaded.files}
