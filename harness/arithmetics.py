"""The ways in which a lane can be asked to compute: native in every precision, others in their one.

What an arithmetic errs by stands in the lane's ledger; here is what no ledger says.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from crosstrace.harness.lanes import REFERENCE, loaded
from crosstrace.translators.ledger import Arithmetic
from crosstrace.translators.native.adapter import UNITS, arithmetic, present
from crosstrace.translators.scene import Scene

DOUBLE, SINGLE = UNITS["f64"], UNITS["f32"]

#: Half a level of an 8-bit image: float32's inflated enclosures are wider than any truth's.
SEEN = 1 / 510

#: An image is kept as the sum of two doubles at most.
_STORED = 2.0**-105

_NAMES = {SINGLE: "float32", DOUBLE: "float64"}


@dataclass(frozen=True)
class Way:
    """One way in which a lane computes; `precision` is its name."""

    lane: str
    precision: str
    arithmetic: Arithmetic

    @property
    def tolerance(self) -> float:
        """The widest inflated enclosure of a pixel of which anything is expected."""
        return SEEN if self.arithmetic.unit >= SINGLE else 1e-9


def ways(lane: str, scene: Scene) -> list[Way]:
    """Return how a lane computes a scene: native in all its precisions, narrowest first."""
    if lane != REFERENCE:
        declared = loaded(lane).ledger(scene).arithmetic
        return [Way(lane, _NAMES[declared.unit], declared)]
    return [Way(lane, name, _as_stored(arithmetic(name))) for name in present()]


def _as_stored(errors: Arithmetic) -> Arithmetic:
    return replace(errors, color_unit=max(errors.color_unit, _STORED))
