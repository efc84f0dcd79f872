"""The Pareto front: the points of which no other is both as fast and as exact."""

from __future__ import annotations

from collections.abc import Sequence


def front(points: Sequence[tuple[float, float]]) -> list[int]:
    """Return the indices of the points (cost, error) that none dominates, cheapest first.

    One point dominates another where it is no worse in both and better in one; of equal points the
    first counts.
    """
    order = sorted(range(len(points)), key=lambda i: (*points[i], i))
    kept: list[int] = []
    for i in order:
        if not kept or points[i][1] < points[kept[-1]][1]:
            kept.append(i)
    return kept
