"""The FLIP difference of two images (Andersson et al. 2020), where `flip-evaluator` is installed.

It says how visible a difference is when a viewer flips between the two display colours, 0…1. A
mean would hide a defect of some pixels, so the greatest and the 99.9th percentile are told.
"""

from __future__ import annotations

from importlib.util import find_spec
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crosstrace.harness.display import display_color
from crosstrace.harness.spread import quantile


def flip(a: NDArray[np.float64], b: NDArray[np.float64]) -> dict[str, float] | None:
    """Return ``max`` and ``p999`` of b against a, linear (v_res, h_res, 3).

    None where the package is not installed or a value is not finite. A screen takes the 8-bit
    image, which has no transfer curve, for sRGB: so does this.
    """
    if find_spec("flip_evaluator") is None:
        return None
    if not (np.isfinite(a).all() and np.isfinite(b).all()):
        return None
    import flip_evaluator

    shown = [np.clip(display_color(image), 0.0, 1.0).astype(np.float32) for image in (a, b)]
    errors: Any = flip_evaluator.evaluate(*shown, "LDR", inputsRGB=True, applyMagma=False)[0]
    return {"max": float(errors.max()), "p999": quantile(np.asarray(errors, np.float64))}
