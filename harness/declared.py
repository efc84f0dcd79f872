"""Departures that a lane declares but no reading reproduces: counted apart, never explained away.

Such a ledger entry cannot be proven by a value. What can be shown is that the pixel's ray tree
meets the situation that the entry names; without that the entry has nothing to do with the pixel.
The pixel stays wrong or suspect either way.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from crosstrace.harness.ray_path import objects_met
from crosstrace.translators.ledger import Entry, Ledger
from crosstrace.translators.native.explain import explain
from crosstrace.translators.native.unexplained import spread
from crosstrace.translators.scene import Scene

#: At most so many pixels have their ray trees looked at, evenly over the image.
LOOKED_AT = 256


@dataclass(frozen=True)
class Met:
    """How many of the pixels looked at meet the situation of one entry of a ledger."""

    effect: str
    situation: str
    pixels: int
    looked_at: int


def unproven(ledger: Ledger) -> list[Entry]:
    """Return the entries about objects that nothing reproduces."""
    return [e for e in ledger if e.fidelity != "exact" and e.objects and not e.readings]


def met(
    scene: Scene, ledger: Ledger, bad: NDArray[np.bool_], readings: Mapping[str, str] | None = None
) -> list[Met]:
    """Look at the ray trees of the pixels of `bad` (v_res, h_res) for each such entry."""
    entries = unproven(ledger)
    pixels = spread(np.flatnonzero(bad), LOOKED_AT)
    if not entries or not len(pixels):
        return []
    trees = [explain(scene, int(p) // scene.h_res, int(p) % scene.h_res, readings) for p in pixels]
    counts = [
        sum(not objects_met(tree, entry.beyond).isdisjoint(entry.objects) for tree in trees)
        for entry in entries
    ]
    return [
        Met(entry.effect, entry.situation, count, len(pixels))
        for entry, count in zip(entries, counts, strict=True)
        if count
    ]
