"""Difference and similarity as pictures, on scales that are fixed and stated, never fitted.

One ramp serves both: a handful of colours chosen by hand whose lightness rises evenly from dark to
light and whose hue goes from blue to yellow, so that it reads the same without colour vision and
in grey. A pixel without any difference is black, one that is not a number is magenta: neither
colour is on the ramp.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

#: Ramp stops as 0…255 sRGB, from the least to the greatest.
STOPS = (
    (24, 32, 78), (38, 62, 122), (52, 94, 142), (70, 127, 145), (104, 156, 139),
    (152, 183, 125), (203, 207, 109), (246, 230, 120), (255, 249, 196),
)  # fmt: skip

#: Classes of pixels in the order of `classes.Class`, as 0…255 sRGB: told apart without colour
#: vision (after Okabe and Ito), the lighter the less is explained.
CLASS_COLORS = (
    (26, 26, 30), (40, 74, 110), (120, 110, 60), (70, 130, 160), (240, 170, 60), (255, 60, 110),
)  # fmt: skip

NOTHING = (0, 0, 0)
NOT_A_NUMBER = (255, 0, 255)

#: The difference scale runs in decades of |a − b| on linear float.
LEAST_DECADE, GREATEST_DECADE = -9, 0

#: The similarity scale runs in decades of 1 − SSIM, up to 1.
LEAST_UNLIKE_DECADE = -6


def ramp(position: NDArray[np.floating[Any]]) -> NDArray[np.uint8]:
    """Colour positions 0…1 (clipped) as (…, 3) 8-bit sRGB; NaN becomes `NOT_A_NUMBER`."""
    table = ramp_table()
    scaled = np.nan_to_num(np.clip(position, 0.0, 1.0), nan=0.0) * (len(table) - 1)
    colors: NDArray[np.uint8] = table[np.rint(scaled).astype(np.intp)]
    colors[np.isnan(position)] = NOT_A_NUMBER
    return colors


def difference_picture(per_pixel: NDArray[np.float64]) -> NDArray[np.uint8]:
    """Draw each pixel's greatest |a − b|, (v_res, h_res), on the logarithmic scale 1e-9…1."""
    with np.errstate(divide="ignore", invalid="ignore"):
        decades = np.log10(per_pixel)
    span = GREATEST_DECADE - LEAST_DECADE
    colors = ramp((decades - LEAST_DECADE) / span)
    colors[per_pixel == 0.0] = NOTHING
    return colors


def similarity_picture(full: NDArray[np.float64]) -> NDArray[np.uint8]:
    """Draw SSIM, the mean over the channels of a map (v_res, h_res, 3), by 1 − SSIM on 1e-6…1.

    Dark is alike and light is unlike, as in the difference picture; 1 − SSIM above 1 is cut, and
    below 1e-9, the rounding of the window's sums, it counts as none.
    """
    unlike = 1.0 - full.mean(axis=2)
    decades = np.log10(np.maximum(unlike, 1e-300))
    colors = ramp(1.0 - decades / LEAST_UNLIKE_DECADE)
    colors[unlike <= 1e-9] = NOTHING
    return colors


def class_picture(classes: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Draw the class of every pixel, (v_res, h_res), in `CLASS_COLORS`."""
    return np.array(CLASS_COLORS, np.uint8)[classes]


def classes_of_picture(picture: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Read the classes, (v_res, h_res), back from their picture; ValueError for another one."""
    same = (picture[..., None, :] == np.array(CLASS_COLORS, np.uint8)).all(axis=-1)
    if not same.any(axis=-1).all():
        raise ValueError("a colour that stands for no class")
    return np.asarray(np.argmax(same, axis=-1), np.uint8)


def css_gradient() -> str:
    """Return the ramp as the stops of a CSS gradient from left to right."""
    return ", ".join(f"rgb({r} {g} {b})" for r, g, b in STOPS)


def difference_ticks() -> list[tuple[float, str]]:
    """Return (position 0…1, label) of the difference scale's marks: its ends and the thresholds."""
    marks = ((-9.0, "1e-9"), (-6.0, "1e-6"), (-4.0, "1e-4"), (float(np.log10(1 / 255)), "1/255"))
    span = GREATEST_DECADE - LEAST_DECADE
    ticks = [((decade - LEAST_DECADE) / span, label) for decade, label in marks]
    return [*ticks, (1.0, "1")]


def similarity_ticks() -> list[tuple[float, str]]:
    """Return (position 0…1, label) of the similarity scale, labelled by SSIM itself."""
    labels = ("0.999999", "0.9999", "0.99", "0.9", "≤ 0")
    decades = (-6, -4, -2, -1, 0)
    return [
        (1 - decade / LEAST_UNLIKE_DECADE, label)
        for decade, label in zip(decades, labels, strict=True)
    ]


def ramp_table(size: int = 256) -> NDArray[np.uint8]:
    """Return the ramp as (size, 3) 8-bit sRGB, from the least to the greatest."""
    at = np.linspace(0, len(STOPS) - 1, size)
    stops = np.array(STOPS, np.float64)
    columns = [np.interp(at, np.arange(len(STOPS)), stops[:, c]) for c in range(3)]
    return np.rint(np.stack(columns, axis=1)).astype(np.uint8)
