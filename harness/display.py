"""From linear float to what a screen shows: the overflow rule and the 8-bit quantisation.

The two choices are named like the readings of the specification: `overflow=scale` divides a colour
whose largest component exceeds 1 by that component, `overflow=clamp` cuts each component at 1;
`quantise=truncate` takes int(255·v + guard), `quantise=round` int(255·v + 1/2). The guard keeps
values that are exact in the scene from hanging on the last bit of the arithmetic.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crosstrace.translators.errors import UsageError

#: For values computed in float64, in 8-bit levels.
GUARD_F64 = 1e-9
#: For values computed or stored in float32.
GUARD_F32 = 5e-5

#: Reading → its values, the default first.
READINGS = {"overflow": ("scale", "clamp"), "quantise": ("truncate", "round")}


@dataclass(frozen=True)
class DisplayRule:
    """How an image becomes 8-bit; the defaults are the course's."""

    overflow: str = "scale"
    quantise: str = "truncate"

    @classmethod
    def split(cls, readings: Mapping[str, str]) -> tuple[DisplayRule, dict[str, str]]:
        """Take this rule's readings out of others; raises UsageError for an unknown value."""
        mine = {name: value for name, value in readings.items() if name in READINGS}
        for name, value in mine.items():
            if value not in READINGS[name]:
                expected = "|".join(READINGS[name])
                raise UsageError(f"reading {name}={value}: expected {expected}, found {value}")
        return cls(**mine), {k: v for k, v in readings.items() if k not in READINGS}


def display_color(image: NDArray[np.floating[Any]], overflow: str = "scale") -> NDArray[np.float64]:
    """Return the colours within 1 by the overflow rule, not quantised; negative ones stay."""
    linear = np.asarray(image, np.float64)
    if overflow == "clamp":
        return np.minimum(linear, 1.0)
    # fmax passes over NaN, so that an undefined component does not take the others with it.
    largest = np.fmax(np.fmax(linear[..., 0], linear[..., 1]), linear[..., 2])
    if not (largest > 1.0).any():
        return linear.copy()
    with np.errstate(invalid="ignore"):
        scaled: NDArray[np.float64] = linear / np.maximum(largest, 1.0)[..., None]
    return scaled


def to_8bit(
    image: NDArray[np.floating[Any]], rule: DisplayRule | None = None, guard: float | None = None
) -> NDArray[np.uint8]:
    """Quantise a linear image (v_res, h_res, 3) to 0…255; what is not a number becomes 0.

    `guard` None: that of float32 where every value is one of float32, of float64 otherwise.
    """
    rule = rule or DisplayRule()
    if rule.quantise == "round":
        guard = 0.5
    elif guard is None:
        guard = GUARD_F32 if is_float32(image) else GUARD_F64
    levels = 255.0 * display_color(image, rule.overflow)
    levels += guard
    np.nan_to_num(levels, copy=False, nan=0.0)
    return np.clip(levels, 0.0, 255.0).astype(np.uint8)


def is_float32(image: NDArray[np.floating[Any]]) -> bool:
    """Whether every value is a number of float32."""
    if image.dtype == np.float32:
        return True
    with np.errstate(over="ignore"):
        return bool(np.array_equal(image, image.astype(np.float32), equal_nan=True))
