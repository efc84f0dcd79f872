"""Digits lost to rounding, pixel by pixel: the same frame under the four rounding modes.

A diagnostic, not a bound. Errors that all four modes make alike do not show: measured on two scenes
against float128, the error exceeds the spread in 0.03 to 0.12 % of pixels, in double by a few last
places, in float also where an edge is decided wrongly in every mode. A pixel whose ray tree differs
between modes shows the whole difference. What it finds is where a picture is sensitive to its
arithmetic, at the cost of four frames.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from crosstrace.native import _core
from crosstrace.translators.effects import effects
from crosstrace.translators.errors import RendererError, UsageError
from crosstrace.translators.scene import Scene

#: Bits of the significand of the precisions that run in any rounding mode.
DIGITS = {"f32": 24, "f64": 53, "f80": 64}

MODES = ("nearest", "up", "down", "zero")


def images_by_mode(scene: Scene, precision: str = "f64", threads: int = 0) -> NDArray[np.float64]:
    """Render under each of `MODES`; returns (4, v_res, h_res, 3, 2), high and low part last.

    Raises UsageError for a precision that is absent or bound to rounding to nearest (f64c, dd,
    f128: their error-free steps need it).
    """
    present = [name for name in _core.precisions() if name in DIGITS]
    if precision not in present:
        raise UsageError(f"rounding modes: expected {' or '.join(present)}, found {precision!r}")
    parts = np.empty((len(MODES), 2, scene.v_res, scene.h_res, 3))
    for mode, (image, low) in zip(MODES, parts, strict=True):
        settings = [("precision", precision), ("rounding", mode), ("threads", str(threads)),
                    ("effects", str(effects(scene).overall))]  # fmt: skip
        try:
            _core.render(scene.native_view(), settings, {"image": image, "image_low": low}, None)
        except RuntimeError as error:
            raise RendererError(f"native: {error}") from None
    return np.moveaxis(parts, 1, -1)


def digits_lost(scene: Scene, precision: str = "f64") -> NDArray[np.float64]:
    """Return log2 of the spread over the modes in units in the last place, (v_res, h_res).

    The greatest of the three channels; 0 where the modes agree to one unit or better. The unit is
    that of `precision` at the pixel's largest channel. Raises as `images_by_mode`.
    """
    modes = images_by_mode(scene, precision)
    # High parts differ exactly or nearly so; low parts carry the digits beyond double.
    apart = modes - modes[:1]
    difference = apart.sum(axis=-1)
    spread = (difference.max(axis=0) - difference.min(axis=0)).max(axis=-1)
    largest = np.abs(modes[0, ..., 0]).max(axis=-1)
    exponent = np.frexp(largest)[1]
    with np.errstate(divide="ignore"):
        lost = np.log2(spread) - (exponent - DIGITS[precision])
    return np.asarray(np.maximum(lost, 0.0), np.float64)
