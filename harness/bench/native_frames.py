"""The native tracer against itself: threads, vectors and certainty.

Frames go into memory that is there, so that it is the tracing that is timed and not how fast the
system finds pages. What runs on one thread is timed by processor time, of which other programs take
nothing; two threads by wall clock.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from crosstrace.harness.bench import rows
from crosstrace.harness.bench.runs import Runs
from crosstrace.harness.jobs import available_cores
from crosstrace.translators.native import timing
from crosstrace.translators.scene import Scene


def measure(name: str, scene: Scene, repeat: int) -> list[dict[str, Any]]:
    """Return the rows of a scene; to be called in a process that does nothing else."""
    image, enclosures = np.zeros(scene.shape), timing.room_for_enclosures(scene)
    one, one_wall, two, scalar, certified = (Runs() for _ in range(5))
    n_rays = 0

    def alone() -> timing.Timed:
        return timing.frame(scene, image)

    ways: dict[str, Callable[[], timing.Timed]] = {
        "one": alone,
        "two": lambda: timing.frame(scene, image, threads=2),
        "scalar": lambda: timing.frame(scene, image, instructions="scalar"),
        "certified": lambda: timing.certified_frame(scene, enclosures),
    }
    if available_cores() < 2:
        del ways["two"]
    for turn in range(repeat + 1):
        found = {key: run() for key, run in ways.items()}
        n_rays = found["one"].n_rays
        if turn == 0:
            continue
        one.values.append(found["one"].processor_s)
        one_wall.values.append(found["one"].wall_s)
        scalar.values.append(found["scalar"].processor_s)
        certified.values.append(found["certified"].processor_s)
        if "two" in found:
            two.values.append(found["two"].wall_s)
    made = [rows.rate(name, one, n_rays)]
    if two.values:
        made.append(rows.threads(name, one_wall, two))
    made.append(rows.against(f"{name}: vector frame, scalar frame", one, scalar))
    made.append(rows.against(f"{name}: certified frame, scalar frame", certified, scalar))
    made.append(rows.against(f"{name}: certified frame, vector frame", certified, one))
    return made
