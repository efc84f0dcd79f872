"""A run as callers want it: scenes in, a report in its directory, the record out."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Executor
from contextlib import ExitStack
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from crosstrace.harness.jobs import WorkerPool, available_cores
from crosstrace.harness.lanes import LANES
from crosstrace.harness.orders import Settings
from crosstrace.harness.publish import publish, workspace
from crosstrace.harness.schedule import Event, Session
from crosstrace.harness.sources import Source, from_scenes
from crosstrace.translators.renderer import RenderOptions
from crosstrace.translators.scene import Scene


@dataclass(frozen=True)
class RunOptions:
    """How to run.

    `jobs` is how many images are worked on at once (0: one a core); `threads` how many each may use
    (0: one where several are worked on at once, all cores otherwise). An image that takes longer
    than `timeout_s` is given up (None: never). `readings` and `precision` are the reference lane's.
    `size` (rows, columns) overrides the resolution. `tolerance` counts as equal on linear float,
    beside what each lane's arithmetic and output cannot hold.
    """

    lanes: tuple[str, ...] = LANES
    jobs: int = 0
    threads: int = 0
    timeout_s: float | None = 120.0
    readings: Mapping[str, str] = field(default_factory=dict)
    precision: str = "f64"
    size: tuple[int, int] | None = None
    tolerance: float = 0.0


def run(
    scenes: Sequence[Scene | Source],
    out: Path,
    options: RunOptions | None = None,
    events: Callable[[Event], None] | None = None,
    executor: Executor | None = None,
) -> dict[str, Any]:
    """Render every scene through every lane, compare, write the report to `out`; return its record.

    `out` gets report.json, report.html and images, all at the end. `events` is called in the
    caller's thread. Another `executor` must see the same file system. Raises UsageError where `out`
    cannot be written; what a renderer does wrong stands in the record.
    """
    options = options or RunOptions()
    slots = options.jobs or available_cores()
    threads = options.threads or (1 if slots > 1 else 0)
    started = time.perf_counter()
    with ExitStack() as stack:
        built = stack.enter_context(workspace(Path(out)))
        pool = executor or stack.enter_context(WorkerPool(slots, threads=threads))
        pixels = built / ".pixels"
        pixels.mkdir()
        rendering = RenderOptions(
            threads=threads, readings=dict(options.readings), precision=options.precision
        )
        settings = Settings(
            options.lanes, built, pixels, rendering, options.timeout_s, options.tolerance
        )
        observe = events or (lambda _: None)
        report = Session(from_scenes(scenes, options.size), settings, pool, observe).run()
        size = list(options.size) if options.size else None
        report["run"] |= {"jobs": slots, "size": size, "seconds": time.perf_counter() - started}
        publish(built, Path(out), report)
    return report
