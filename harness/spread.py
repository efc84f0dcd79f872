"""How differences are spread: counts between fixed edges, for curves and tolerances.

The edges are the same in every report, six a decade, so that curves can be laid over each other and
a tolerance taken from them is a number that can be written down: 1e-16, 1.5e-16, 2e-16, … 1000.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

#: Factors of the powers of ten.
_STEPS = ("1", "1.5", "2", "3", "5", "7")
_LEAST, _GREATEST = -16, 3

#: Upper ends of the bins as texts, which are a record's keys, and as numbers.
TEXTS = (
    *(f"{step}e{decade}" for decade in range(_LEAST, _GREATEST) for step in _STEPS),
    f"1e{_GREATEST}",
)
EDGES = tuple(map(float, TEXTS))

#: The quantile that is told beside the greatest: of 1000 pixels one is worse.
P999 = 0.999


def spread(values: NDArray[np.float64]) -> dict[str, Any]:
    """Count magnitudes: ``none`` are 0, ``counts`` are those of each bin, ``beyond`` the rest.

    ``counts`` maps the upper end of each bin that is not empty to what is above the edge before (0
    for the first) and at most that end. ``beyond`` is greater than the last edge or not a number,
    so that the values above a tolerance that is an edge are those of all greater ends and
    ``beyond``.
    """
    flat = np.abs(values).ravel()
    some = flat[flat > 0]
    at = np.searchsorted(EDGES, some, side="left")
    counts = np.bincount(at, minlength=len(EDGES) + 1)
    undefined = int(np.count_nonzero(np.isnan(flat)))
    return {
        "none": int(np.count_nonzero(flat == 0)),
        "counts": {text: int(n) for text, n in zip(TEXTS, counts, strict=False) if n},
        "beyond": int(counts[len(EDGES)]) + undefined,
    }


def quantile(values: NDArray[np.float64], share: float = P999) -> float:
    """Return the least value that at least this share of the values does not exceed.

    NaN is greater than any number; infinite where it is reached.
    """
    flat = np.where(np.isnan(values), np.inf, np.abs(values)).ravel()
    if not flat.size:
        return 0.0
    rank = max(0, math.ceil(share * flat.size) - 1)
    return float(np.partition(flat, rank)[rank])
