"""A logarithmic axis with a place for 0 beyond its end."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

#: The part of an axis that 0 takes, where something is 0.
_ZERO_SHARE = 0.06

#: Labels at most.
_MOST_LABELS = 12


@dataclass(frozen=True)
class Axis:
    """From the exponents (base 10) `low`…`high` to the coordinates `start`…`end`."""

    low: float
    high: float
    start: float
    end: float
    has_zero: bool = False

    @classmethod
    def around(cls, values: Sequence[float], start: float, end: float) -> Axis:
        """Make an axis on which numbers ≥ 0 have room; the ends are whole decades or halves."""
        positive = [math.log10(value) for value in values if value > 0] or [0.0]
        low, high = min(positive) - 0.1, max(positive) + 0.1
        low, high = math.floor(2 * low) / 2, math.ceil(2 * high) / 2
        return cls(low, high, start, end, any(value == 0 for value in values))

    def __call__(self, value: float) -> float:
        """Return the coordinate of a number ≥ 0."""
        length = self.end - self.start
        share = _ZERO_SHARE if self.has_zero else 0.0
        if value <= 0:
            return self.start + length * share / 3
        part = (math.log10(value) - self.low) / (self.high - self.low)
        return self.start + length * (share + (1 - share) * part)


def decades(axis: Axis) -> range:
    """Return the exponents to be labelled: every decade, or every so many."""
    first, last = math.ceil(axis.low), math.floor(axis.high)
    step = max(1, math.ceil((last - first) / _MOST_LABELS))
    # Multiples of the step, so that 1 is one of them where it is on the axis.
    return range(math.ceil(first / step) * step, last + 1, step)
