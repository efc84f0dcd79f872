"""The measurements of `crosstrace bench`, in the order that keeps a comparison fair.

All that is compared is measured in one run, one after the other in every turn, so that whatever
else the machine does meets both sides; a first turn warms kernels, caches and pages and does not
count. Pure intersection is of one thread, and so is the peak of products and sums that it is held
against. For Mitsuba and POV-Ray a frame is what the report times: without their start-up, but for
POV-Ray's, which is a program of its own.
Rows hold medians, and every run is kept. Frames are timed by wall clock in worker processes, as
every lane is; intersection alone by the processor time of its one thread.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

from crosstrace.harness import alone
from crosstrace.harness.bench import rows
from crosstrace.harness.jobs import Task, available_cores
from crosstrace.harness.lanes import LANES, REFERENCE
from crosstrace.harness.sources import Source
from crosstrace.translators.errors import CrosstraceError
from crosstrace.translators.renderer import RenderOptions
from crosstrace.translators.scene import Scene

#: Scenes and size, unless asked otherwise.
SCENES, SIZE = ("glass-bench", "phong-bench", "vidro4"), (1080, 1920)

#: How often each block of rays is traced where memory is not to count.
PASSES = 16

Told = Callable[[float, str], None]


@dataclass
class Runs:
    """Numbers of one measurement, run by run; or why there are none."""

    values: list[float] = field(default_factory=list)
    status: str = "ok"
    message: str = ""

    def fail(self, status: str, error: CrosstraceError) -> None:
        """Take note that there will be none."""
        self.values, self.status, self.message = [], status, str(error)


def bench(sources: Sequence[Source], repeat: int, timeout_s: float, told: Told) -> dict[str, Any]:
    """Measure scenes and return the record: `machine`, `settings` and `rows`, JSON-ready."""
    from crosstrace.harness.environment import describe

    made: list[dict[str, Any]] = []
    for i, source in enumerate(sources):

        def part(share: float, begin: int = i, name: str = source.name) -> None:
            told((begin + share) / len(sources), name)

        made += _frames(source, repeat, timeout_s, lambda share: part(0.8 * share))
        made += _intersection(source, repeat, timeout_s)
        part(1.0)
    settings = {
        "scenes": [source.name for source in sources],
        "size": [[source.scene.v_res, source.scene.h_res] for source in sources],
        "repeat": repeat,
    }
    return {"machine": describe(), "settings": settings, "rows": made}


def _frames(
    source: Source, repeat: int, timeout_s: float, told: Callable[[float], None]
) -> list[dict[str, Any]]:
    """Time whole frames: native on one thread and on two, then every lane on all cores.

    The speed of one thread is taken of its processor time, which other programs take nothing from.
    """
    alone_s, n_rays = Runs(), 0
    one_thread = Task(one_thread_frame, "bench", timeout_s=timeout_s, label="native")
    ways = {"one": (REFERENCE, 1), "two": (REFERENCE, 2)} | {lane: (lane, 0) for lane in LANES}
    runs = {key: Runs() for key in ways}
    for turn in range(repeat + 1):
        seconds, n_rays = alone.call(one_thread, source.scene)
        if turn > 0:
            alone_s.values.append(seconds)
        for k, (key, (lane, threads)) in enumerate(ways.items()):
            told((turn + k / len(ways)) / (repeat + 1))
            if runs[key].status != "ok":
                continue
            how = RenderOptions(threads, timeout_s=timeout_s)
            try:
                if turn == 0 and not (probe := alone.probe(lane)).available:
                    runs[key].status, runs[key].message = "missing", probe.reason
                    continue
                frame, _ = alone.render(lane, source.scene, how)
            except CrosstraceError as error:
                runs[key].fail("failed", error)
                continue
            if turn > 0:
                runs[key].values.append(frame.seconds.render)
    made = [rows.rate(source.name, alone_s, n_rays)]
    if available_cores() > 1:
        made.append(rows.threads(source.name, runs["one"], runs["two"]))
    return made + [
        rows.frame(source.name, lane, runs[REFERENCE], runs[lane])
        for lane in LANES
        if lane != REFERENCE
    ]


def _intersection(source: Source, repeat: int, timeout_s: float) -> list[dict[str, Any]]:
    task = Task(measure_rays, "bench", timeout_s=timeout_s, label="measuring intersection")
    found: list[dict[str, Any]] = alone.call(task, source.name, source.scene, repeat)
    return found


def one_thread_frame(scene: Scene) -> tuple[float, int]:
    """Render natively on one thread; return the processor time in seconds, and the rays."""
    from crosstrace.harness.lanes import loaded

    started = time.process_time()
    made = loaded(REFERENCE).render(scene, RenderOptions(threads=1))
    seconds = time.process_time() - started
    return seconds, made.n_rays or 0


def measure_rays(name: str, scene: Scene, repeat: int) -> list[dict[str, Any]]:
    """Measure nearest hits alone, ours and Embree's, and ours against the machine's peak.

    Runs in a worker, whose threads and memory are its own.
    """
    from crosstrace.harness.bench import embree
    from crosstrace.harness.bench.rays import of_picture
    from crosstrace.translators.native.intersect import (
        instruction_sets,
        nearest,
        operations,
        peak_flops,
    )

    sets = instruction_sets()
    others, absent = [], "the package embreex (extra `bench`) or libembree3-3 is not installed"
    for library in embree.libraries():
        try:
            others.append(embree.Embree(library, scene))
        except (OSError, AttributeError) as error:
            absent = str(error)
    made = []
    for rays in of_picture(scene):
        ours, resident, peaks = Runs(), {it: Runs() for it in sets}, {it: Runs() for it in sets}
        theirs = {(e.version, mode): Runs() for e in others for mode in e.modes}
        agreement: dict[str, float] = {}
        n_operations = operations(scene, rays.origins, rays.directions)
        for turn in range(repeat + 1):
            _, hit, seconds = nearest(scene, rays.origins, rays.directions)
            sums = {"": (ours, len(rays) / seconds / 1e6)}
            for e in others:
                for mode in e.modes:
                    found, seconds = e.nearest(mode, rays)
                    sums[f"{e.version} {mode}"] = (
                        theirs[e.version, mode], len(rays) / seconds / 1e6
                    )  # fmt: skip
                    agreement[e.version] = float((found == hit).mean())
            for it in sets if rays.kind == "primary" else []:
                _, _, seconds = nearest(scene, rays.origins, rays.directions, PASSES, it, "scan")
                sums[f"resident {it}"] = resident[it], PASSES * n_operations / seconds / 1e9
                sums[f"peak {it}"] = peaks[it], peak_flops(it) / 1e9
            if turn > 0:
                for into, value in sums.values():
                    into.values.append(value)
        made.append(rows.embree(name, rays.kind, ours, theirs, agreement, absent))
        if rays.kind == "primary":
            made += [rows.peak(name, it, resident[it], peaks[it]) for it in sets]
    for e in others:
        e.close()
    return made
