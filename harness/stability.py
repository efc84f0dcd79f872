"""How far scenes can be trusted numerically: measured in workers, held to what indexes promise.

`study` gives each scene's measurements and, where asked, the metamorphic checks of some lanes, as
they come in; a scene or lane whose worker fails is reported and the rest goes on.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import Future, as_completed
from dataclasses import asdict, dataclass, field
from typing import Any

from crosstrace.harness import metamorphic, tasks
from crosstrace.harness.jobs import Task, WorkerPool, available_cores
from crosstrace.harness.lanes import LANES
from crosstrace.harness.metamorphic import Outcome
from crosstrace.harness.sources import Source, sized
from crosstrace.translators.errors import (
    CrosstraceError,
    RendererMissingError,
    UnsupportedSceneError,
)
from crosstrace.translators.native.stability import Stability, summary
from crosstrace.translators.native.thresholds import departures
from crosstrace.translators.renderer import RenderOptions
from crosstrace.translators.scene import Scene

#: Rows of a larger scene by default: float128 takes some 70 times as long as double.
MOST_ROWS = 120


@dataclass(frozen=True)
class Options:
    """How to measure: `jobs` at once (0: one a core), `lanes` to check metamorphically.

    `size` (rows, columns) overrides the default, which is the scene's own up to `MOST_ROWS` rows.
    """

    lanes: tuple[str, ...] = ()
    size: tuple[int, int] | None = None
    jobs: int = 0
    threads: int = 0
    timeout_s: float | None = 300.0


@dataclass
class Entry:
    """What is known of one scene so far.

    `found` is None until it is measured; `outcomes` has the metamorphic checks by lane. `failures`
    name what gave no result and why, `unsupported` the lanes that cannot express the scene.
    """

    source: Source
    scene: Scene
    found: Stability | None = None
    departures: list[str] = field(default_factory=list)
    outcomes: dict[str, list[Outcome]] = field(default_factory=dict)
    failures: dict[str, str] = field(default_factory=dict)
    unsupported: dict[str, str] = field(default_factory=dict)

    @property
    def at_own_size(self) -> bool:
        """Whether it was measured at the size for which thresholds are stated."""
        return self.scene.shape == self.source.scene.shape

    @property
    def checks(self) -> list[Outcome]:
        """The metamorphic checks, lane by lane in the order of the lanes."""
        return [it for lane in LANES for it in self.outcomes.get(lane, ())]

    @property
    def broken(self) -> list[Outcome]:
        """The metamorphic checks that do not hold."""
        return [it for it in self.checks if it.over]


@dataclass(frozen=True)
class Event:
    """A job that ended: of which scene, by what; `failed` where it gave no result.

    `stage` names the part of the work that it belongs to.
    """

    done: int
    total: int
    scene: str
    what: str
    failed: str = ""
    stage: str = ""

    @property
    def progress(self) -> tuple[int, int, str, bool]:
        """Steps done, of how many, what ended in words, and whether it failed."""
        text = f"{self.scene} {self.what}".strip()
        text += f": {self.failed}" if self.failed else ""
        return self.done, self.total, text, bool(self.failed)


def entries(sources: Sequence[Source], size: tuple[int, int] | None) -> list[Entry]:
    """Return what is to be measured, at the size at which it is."""
    return [Entry(source, sized(source.scene, size, MOST_ROWS)) for source in sources]


def study(todo: Sequence[Entry], options: Options) -> Iterator[Event]:
    """Measure, filling the entries; gives an event for each job that ends."""
    slots = options.jobs or available_cores()
    threads = options.threads or (1 if slots > 1 else 0)
    how = RenderOptions(threads, timeout_s=options.timeout_s)
    with WorkerPool(slots, threads=threads) as pool:
        jobs: dict[Future[Any], tuple[Entry, str]] = {}
        for entry in todo:
            name = entry.source.name
            task = Task(tasks.stability, "native", timeout_s=options.timeout_s, label=name)
            jobs[pool.submit(task, entry.scene, threads)] = entry, ""
            for lane in options.lanes:
                label = f"{lane} on {name}"
                task = Task(metamorphic.check, lane, 1, options.timeout_s, label)
                jobs[pool.submit(task, lane, entry.scene, how)] = entry, lane
        for done, future in enumerate(as_completed(jobs), 1):
            entry, lane = jobs[future]
            failed = _keep(entry, lane, future)
            stage = "relations" if lane else "rungs"
            yield Event(done, len(jobs), entry.source.name, lane, failed, stage)


def exit_status(done: Sequence[Entry]) -> int:
    """Return 1 where a promise or a check is broken, else 3 where something gave no result."""
    if any(entry.departures or entry.broken for entry in done):
        return 1
    return 3 if any(entry.failures for entry in done) else 0


def record(done: Sequence[Entry]) -> dict[str, Any]:
    """Return the JSON-ready result; `scenes[]` has the stable keys of the interface."""
    return {"scenes": [_scene_record(entry) for entry in done]}


def _scene_record(entry: Entry) -> dict[str, Any]:
    rows, columns, _ = entry.scene.shape
    nothing: dict[str, Any] = {"certified_fraction": None, "undecidable": None, "rungs": []}
    written: dict[str, Any] = {
        "name": entry.source.name,
        "sha256": entry.scene.sha256,
        "size": [rows, columns],
        "own_size": list(entry.source.scene.shape[:2]),
        **(nothing if entry.found is None else summary(entry.found)),
        "stable": _verdict(entry),
        "departures": entry.departures,
        "failures": entry.failures,
        "unsupported": entry.unsupported,
    }
    if entry.outcomes:
        written["metamorphic"] = [asdict(it) for it in entry.checks]
    return written


def _verdict(entry: Entry) -> bool | None:
    """Say whether the index's thresholds are kept; None: none are stated for this size."""
    judged = entry.found is not None and entry.at_own_size and entry.source.stable
    return not entry.departures if judged else None


def _keep(entry: Entry, lane: str, future: Future[Any]) -> str:
    """Put a job's result in its place; return why there is none."""
    try:
        result = future.result()
    except UnsupportedSceneError as error:
        entry.unsupported[lane or "native"] = str(error)
        return ""
    except CrosstraceError as error:
        reason = error.reason if isinstance(error, RendererMissingError) else str(error)
        entry.failures[lane or "rungs"] = reason
        return reason
    if lane:
        entry.outcomes[lane] = result
        return ""
    entry.found = result
    stated: Mapping[str, Mapping[str, float]] = entry.source.stable
    if stated and entry.at_own_size:
        entry.departures = departures(result.rungs, stated)
    return ""
