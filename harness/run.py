"""A run as callers want it: scenes in, a report in its directory, the record out."""

from __future__ import annotations

import time
from collections.abc import Callable
from concurrent.futures import Executor
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from crosstrace.harness.jobs import WorkerPool, available_cores
from crosstrace.harness.publish import publish, workspace
from crosstrace.harness.session import Event, Session, Settings
from crosstrace.harness.sources import Source
from crosstrace.translators.renderer import RenderOptions

#: An image that takes longer is given up.
TIMEOUT_S = 300.0


@dataclass(frozen=True)
class Finished:
    """The record of a run and the page drawn from it."""

    report: dict[str, Any]
    page: Path


def run_sources(
    sources: list[Source],
    lanes: tuple[str, ...],
    directory: Path,
    *,
    jobs: int | None = None,
    timeout_s: float | None = TIMEOUT_S,
    observe: Callable[[Event], None] = lambda event: None,
    executor: Executor | None = None,
) -> Finished:
    """Render and compare scenes and write the report to `directory`.

    `jobs` is how many images are worked on at once, None: one a core; a single one gets all cores.
    Another `executor` must see the same file system. Raises UsageError where `directory` cannot be
    written; what a renderer does wrong stands in the record.
    """
    slots = jobs or available_cores()
    threads = 0 if slots == 1 else 1
    started = time.perf_counter()
    with workspace(directory) as built, WorkerPool(slots, threads=threads) as pool:
        pixels = built / ".pixels"
        pixels.mkdir()
        options = RenderOptions(threads=threads)
        settings = Settings(lanes, built, pixels, options, timeout_s, observe)
        report = Session(sources, settings, executor or pool).run()
        report["run"] |= {"jobs": slots, "seconds": time.perf_counter() - started}
        return Finished(report, publish(built, directory, report))
