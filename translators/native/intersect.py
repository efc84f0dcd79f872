"""Nearest hits of given rays, and what this machine's plain arithmetic is good for: to measure."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from crosstrace.native import _core
from crosstrace.translators.scene import Scene

Array = NDArray[np.float64]


def instruction_sets() -> list[str]:
    """Return the instruction sets of this processor that streams are built for, narrowest first."""
    return [name for name in _core.instructions() if name in ("generic", "avx2", "avx512")]


def nearest(
    scene: Scene,
    origins: Array,
    directions: Array,
    passes: int = 1,
    instructions: str = "native",
    search: str = "auto",
    tree: Any = None,
) -> tuple[Array, NDArray[np.int64], float]:
    """Return the distances (n,), objects (n,) and the processor time in seconds that rays took.

    `origins` and `directions` are (3, n), directions of length 1; where nothing is hit the distance
    is infinite and the object -1. Each block of rays is traced `passes` times. `tree` is what
    `_core.tree` made of the scene, so that building it takes no time here.
    """
    n = origins.shape[1]
    # Written to, so that no page is new while time is taken.
    t, hit = np.full(n, np.nan), np.full(n, -2, np.int64)
    view = scene.native_view()
    settings = [("instructions", instructions), ("search", search)]
    seconds = _core.intersect(view, settings, n, origins, directions, passes,
                              {"t": t, "object": hit}, tree)  # fmt: skip
    return t, hit, seconds


def peak_flops(instructions: str, seconds: float = 0.2) -> float:
    """Return the most float64 products and sums a second of one core, none of them fused."""
    return _core.peak_flops(instructions, seconds)


def operations(scene: Scene, origins: Array, directions: Array) -> int:
    """Count the operations that the nearest hits of these rays need of a scan of all objects.

    Sums, products, quotients and roots count as one each, comparisons and signs as none. A sphere
    takes 14 for a ray that starts outside and leaves it, 26 for one that misses, 29 for one that
    hits; a plane 13 for a ray that does not near it, else 14 (`native/src/stream_hit.inc.h`). A
    vector of rays does all that one of its rays needs, so the machine does more than is counted.
    """
    total = 0
    for is_sphere, row in zip(scene.is_sphere.tolist(), scene.geometry, strict=True):
        if is_sphere:
            f = origins - row[:3, None]
            b = -(f * directions).sum(axis=0)
            c = (f * f).sum(axis=0) - row[3] ** 2
            near = ~((b < 0) & (c > 0))
            across = f[:, near] + b[near] * directions[:, near]
            hits = (across * across).sum(axis=0) <= row[3] ** 2
            total += 14 * len(b) + 12 * int(near.sum()) + 3 * int(hits.sum())
        else:
            normal = row[3:] / np.linalg.norm(row[3:])
            slope = normal @ directions
            rise = normal @ (row[:3, None] - origins)
            total += 13 * len(slope) + int(((slope > 0) == (rise > 0)).sum())
    return total
