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
    ways: dict[str, Callable[[], timing.Timed]] = {
        "one": lambda: timing.frame(scene, image),
        "scalar": lambda: timing.frame(scene, image, instructions="scalar"),
        "certified": lambda: timing.certified_frame(scene, enclosures),
    }
    if available_cores() > 1:
        ways["two"] = lambda: timing.frame(scene, image, threads=2)
    timed: dict[str, list[timing.Timed]] = {key: [] for key in ways}
    for turn in range(repeat + 1):
        for key, run in ways.items():
            found = run()
            if turn > 0:
                timed[key].append(found)

    def processor(key: str) -> Runs:
        return Runs([it.processor_s for it in timed[key]])

    def wall(key: str) -> Runs:
        return Runs([it.wall_s for it in timed[key]])

    one, scalar, certified = map(processor, ("one", "scalar", "certified"))
    made = [rows.rate(name, one, timed["one"][0].n_rays)]
    if "two" in ways:
        made.append(rows.threads(name, wall("one"), wall("two")))
    return [
        *made,
        rows.against(f"{name}: vector frame, scalar frame", one, scalar),
        rows.against(f"{name}: certified frame, scalar frame", certified, scalar),
        rows.against(f"{name}: certified frame, vector frame", certified, one),
    ]
