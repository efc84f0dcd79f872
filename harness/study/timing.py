"""How long a rendering takes: warmed up, several times, nothing thrown away.

These run in a worker. A run is translating and rendering; what a renderer pays for starting stands
apart (`Seconds.startup`). Beside wall time stands the processor time of the worker, all its threads
and children, which other work on the machine disturbs less; a child's start-up is part of it.
"""

from __future__ import annotations

import resource
import statistics
import time
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crosstrace.harness import tasks
from crosstrace.translators.renderer import RenderOptions
from crosstrace.translators.scene import Scene

Array = NDArray[np.float64]

#: Runs at least, and the time after which there are no more than these.
LEAST_RUNS, ENOUGH_S = 3, 2.0

#: A quick rendering is warmed up for so long, and then run for so long, but not more often: seven
#: runs of 2 ms were seen to take twice as long as the same ones a second later.
WARM_S, BRIEF_S, MOST_RUNS = 0.1, 0.25, 60


@dataclass
class Timed:
    """An image, and what its runs took in seconds; `warm_up` is a first run apart.

    `low` is what rounding the image to double left out (0: nothing is known of it); `rays` counts
    all rays of one run (None: the renderer does not say).
    """

    image: Array
    low: Array | float
    half_step: float
    rays: int | None
    warm_up: float
    runs: list[float] = field(default_factory=list)
    processor: list[float] = field(default_factory=list)
    startup: list[float] = field(default_factory=list)

    def record(self, clock: str) -> dict[str, Any]:
        """Return the times, JSON-ready: medians, half the interquartile range as spread, all runs.

        `seconds` and `spread` are those of a clock, ``wall`` or ``processor``.
        """
        told = self.processor if clock == "processor" else self.runs
        return {
            "seconds": statistics.median(told),
            "spread": spread(told),
            "wall_seconds": statistics.median(self.runs),
            "processor_seconds": statistics.median(self.processor),
            "startup_seconds": statistics.median(self.startup),
            "runs": self.runs,
            "processor_runs": self.processor,
            "startup_runs": self.startup,
            "warm_up": self.warm_up,
            "rays": self.rays,
        }


def spread(values: list[float]) -> float:
    """Return half the distance of the quartiles, in the unit of the values."""
    low, high = np.quantile(values, [0.25, 0.75])
    return float(high - low) / 2


def timed(lane: str, scene: Scene, options: RenderOptions, runs: int) -> Timed:
    """Render once to warm up, and for the clock `runs` times: more where that is quick, fewer where
    it takes long.
    """

    def once() -> tuple[Any, float]:
        made, _ = tasks.render(lane, scene, options)
        return made, made.seconds.startup

    made, found = _measured(once, runs)
    found.image, found.half_step = made.image, made.half_step
    found.rays = made.n_rays
    if options.precision in ("f80", "dd", "f128"):
        again, _ = tasks.render(lane, scene, replace(options, layers=True))
        found.low = again.layers["image_low"]
    return found


def timed_certify(scene: Scene, threads: int, runs: int) -> tuple[Timed, dict[str, Array]]:
    """Certify as `timed` renders; the image is the middle of each enclosure."""
    from crosstrace.translators.native.truth import certify

    known, found = _measured(lambda: (certify(scene, threads=threads), 0.0), runs)
    found.image = (known.lo + known.hi) / 2
    return found, {"lo": known.lo, "hi": known.hi, "undecidable": known.undecidable}


def _measured(once: Callable[[], tuple[Any, float]], runs: int) -> tuple[Any, Timed]:
    started = time.perf_counter()
    made, startup = once()
    found = Timed(np.empty(0), 0.0, 0.0, None, time.perf_counter() - started - startup)
    while time.perf_counter() - started - startup < WARM_S:
        made, _ = once()
    begun = time.perf_counter()
    while _goes_on(len(found.runs), runs, time.perf_counter() - begun):
        before, processor = time.perf_counter(), _processor_s()
        made, startup = once()
        found.runs.append(max(0.0, time.perf_counter() - before - startup))
        found.processor.append(_processor_s() - processor)
        found.startup.append(startup)
    return made, found


def _goes_on(done: int, wanted: int, elapsed_s: float) -> bool:
    """Say whether there is to be another run, after so many and so much time."""
    if done < LEAST_RUNS:
        return True
    if done < wanted:
        return elapsed_s <= ENOUGH_S
    return done < MOST_RUNS and elapsed_s < BRIEF_S


def _processor_s() -> float:
    ended = resource.getrusage(resource.RUSAGE_CHILDREN)
    return time.process_time() + ended.ru_utime + ended.ru_stime
