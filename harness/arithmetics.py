"""How each lane computes: the errors of its arithmetic, and its own rules as readings."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from crosstrace.harness.lanes import REFERENCE
from crosstrace.translators.native.adapter import UNITS, present

DOUBLE, SINGLE = UNITS["f64"], UNITS["f32"]

#: Half a level of an 8-bit image: float32's inflated enclosures are wider than any truth's.
SEEN = 1 / 510

#: An image is kept as the sum of two doubles at most.
_STORED = 2.0**-105


@dataclass(frozen=True)
class Arithmetic:
    """How a lane computes: relative errors κ·unit of geometry and `color_unit` of colours.

    κ is 2 for native, where 1 leaves some float32 pixels outside, and 4 elsewhere: Mitsuba's camera
    alone needs 3. `readings` state the lane's own rules, from the settings of one of its images.
    `tolerance` is the widest inflated enclosure of a pixel of which anything is expected.
    """

    lane: str
    precision: str
    unit: float
    kappa: float
    color_unit: float
    tolerance: float = 1e-9
    readings: Callable[[Mapping[str, Any]], dict[str, str]] = field(default=lambda settings: {})


def arithmetics(lane: str) -> list[Arithmetic]:
    """Return how a lane computes: native's rungs, or the one way of another lane."""
    if lane == REFERENCE:
        return [
            Arithmetic(lane, name, UNITS[name], 2.0, max(UNITS[name], _STORED),
                       SEEN if name == "f32" else 1e-9)
            for name in present()
        ]  # fmt: skip
    return {
        "mitsuba": [Arithmetic(lane, "float32", SINGLE, 4.0, SINGLE, SEEN,
                               lambda settings: {"offset": "mitsuba"})],
        "mitsuba-f64": [Arithmetic(lane, "float64", DOUBLE, 4.0, DOUBLE)],
        "povray": [Arithmetic(lane, "double", DOUBLE, 4.0, SINGLE, 1e-9, _povray_limits)],
    }[lane]  # fmt: skip


def _povray_limits(settings: Mapping[str, Any]) -> dict[str, str]:
    """State what POV-Ray passes over (povray/scale.py): hits nearer than 1e-4, for shadows 1e-3.

    To start at that distance is the same; what is left of the 1e-3 counts from there.
    """
    scale = settings["world_scale"]
    return {"epsilon": repr(1e-4 / scale), "shadow_min": repr(9e-4 / scale),
            "far": repr(1e7 / scale)}  # fmt: skip
