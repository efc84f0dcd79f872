"""How much a planted fault changes: pixels that differ by more than a lane's own noise.

Two renderings of one lane differ without meaning anything by what its arithmetic and its output
lose. A fault that stays below that everywhere cannot be caught by anybody.
"""

from __future__ import annotations

import numpy as np

from crosstrace.harness.metrics import difference, pixel_difference
from crosstrace.translators.renderer import Rendering

#: What arithmetic alone does to a value near 1. On the packaged course scenes (120 × 160) povray
#: leaves native by half a step and 1.9e-7 at most, mitsuba-f64 by 1.4e-13; mitsuba leaves native
#: under offset=mitsuba by less than 8e-7 in 99 % of the pixels, by more than 1e-5 in 3 of 19,200.
ARITHMETIC = {"native": 1e-9, "mitsuba": 1e-5, "mitsuba-f64": 1e-9, "povray": 1e-6}

#: What float32 does, in the native tracer too; an unknown lane is believed no more than that.
FLOAT32 = 1e-5


def noise(lane: str, a: Rendering, b: Rendering) -> float:
    """Return what two honest renderings of a lane may differ by, on linear float near 1.

    Half a step of each output's quantisation and the lane's arithmetic.
    """
    narrow = "f32" in (a.settings.get("precision"), b.settings.get("precision"))
    arithmetic = FLOAT32 if narrow else ARITHMETIC.get(lane, FLOAT32)
    return arithmetic + a.half_step + b.half_step


def changed_pixels(lane: str, honest: Rendering, faulty: Rendering) -> int:
    """Count the pixels of which a channel differs by more than noise, relative beyond 1.

    What is not a number in one image alone counts as changed.
    """
    per_pixel = pixel_difference(difference(honest.image, faulty.image))
    size = np.fmax(np.abs(honest.image).max(axis=2), 1.0)
    size[~np.isfinite(size)] = 1.0
    same_gap = np.isnan(honest.image).any(axis=2) & np.isnan(faulty.image).any(axis=2)
    within = (per_pixel <= noise(lane, honest, faulty) * size) | same_gap
    return int(per_pixel.size - np.count_nonzero(within))
