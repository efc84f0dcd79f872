"""Numbers as short texts for the page: the template's filters."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any
from urllib.parse import quote

import numpy as np

from crosstrace.harness import colormap


def significant(value: float | None, digits: int = 2) -> str:
    """Return a number in few characters: 0, 0.034, 3.4e-7; a dash for none."""
    if value is None:
        return "–"
    if value == 0 or not math.isfinite(value):
        return f"{value:g}"
    if 1e-3 <= abs(value) < 1e5:
        return f"{value:.{digits}g}" if abs(value) < 10 else f"{value:.{digits + 2}g}"
    mantissa, _, exponent = f"{value:.{digits - 1}e}".partition("e")
    return f"{mantissa}e{int(exponent)}"


def seconds(value: float | None) -> str:
    """Return seconds to the millisecond, or to a tenth from ten on; a dash for none."""
    if value is None:
        return "–"
    return f"{value:.3f}" if value < 10 else f"{value:.1f}"


def similarity(value: float | None) -> str:
    """Return an SSIM so that only exactly 1 reads as 1: 0.999964, 1 − 3e-9."""
    if value is None or value == 1:
        return "–" if value is None else "1"
    if value > 1:  # by the rounding of the window's sums
        return f"1 + {significant(value - 1, 1)}"
    return f"1 − {significant(1 - value, 1)}" if value > 1 - 5e-7 else f"{value:.6f}"


def count(value: int | None) -> str:
    """Return a count with thin spaces between thousands; a dash for none."""
    return "–" if value is None else f"{value:,}".replace(",", "\u202f")


def mebibytes(value: float | None) -> str:
    """Return a size in whole MiB; a dash for none."""
    return "–" if value is None else f"{value:.0f}"


def swatch(value: float | None) -> str:
    """Return the colour that the difference scale gives to a value, as CSS."""
    position = np.array([[math.nan if value is None else value]])
    red, green, blue = colormap.difference_picture(position)[0, 0]
    return f"rgb({red} {green} {blue})"


def link(name: str) -> str:
    """Return a relative file name as a URL that can be nothing else."""
    return quote(name, safe="/")


FILTERS: dict[str, Callable[..., Any]] = {
    "sig": significant,
    "count": count,
    "swatch": swatch,
    "link": link,
    "seconds": seconds,
    "similarity": similarity,
    "mib": mebibytes,
}
