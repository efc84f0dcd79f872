"""The experiment: references first, then every point of every scene, one after the other.

Nothing else of ours runs beside a point that is timed. A renderer that is missing or fails is
reported, and the rest goes on.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass, field, replace
from typing import Any

from crosstrace.harness.jobs import Task, WorkerPool
from crosstrace.harness.lanes import LANES
from crosstrace.harness.sources import Source, sized
from crosstrace.harness.stability import MOST_ROWS, Event
from crosstrace.harness.study import pareto, references, timing
from crosstrace.harness.study.errors import Error, Value, half_widths, measured
from crosstrace.harness.study.points import (
    AGAINST,
    FOREIGN_SIDES,
    KINDS,
    SIDES,
    Point,
    bounces,
    plan,
)
from crosstrace.translators.errors import CrosstraceError, RendererMissingError
from crosstrace.translators.scene import Scene

#: What errors are measured against, as `points.AGAINST` names it.
REFERENCES = ("certified", "deep", "average")


@dataclass(frozen=True)
class Options:
    """How to study.

    `threads` of a renderer (0: all cores): one by default, so that times compare. `runs` at most
    for the clock, fewer where they take long; `samples` a side at most. `size` (rows, columns)
    overrides the default, which is the scene's own up to `stability.MOST_ROWS` rows. `metric` is
    the error by which points are on the Pareto front, `clock` (wall, processor) the time.
    """

    lanes: tuple[str, ...] = LANES
    size: tuple[int, int] | None = None
    threads: int = 1
    runs: int = 7
    samples: int = 32
    timeout_s: float | None = 300.0
    metric: str = "rmse"
    clock: str = "wall"


@dataclass
class Entry:
    """What is known of one scene so far: its references, and its points' records.

    `failures` name what gave no result and why. `name` is how a command line names the scene, and
    `size` what it says of the size, if anything.
    """

    source: Source
    scene: Scene
    name: str
    size: tuple[int, int] | None
    values: dict[str, Value] = field(default_factory=dict)
    references: dict[str, dict[str, Any]] = field(default_factory=dict)
    own: dict[str, Value | None] = field(default_factory=dict)
    plan: list[Point] = field(default_factory=list)
    points: list[dict[str, Any]] = field(default_factory=list)
    failures: dict[str, str] = field(default_factory=dict)


def entries(sources: Sequence[Source], size: tuple[int, int] | None) -> list[Entry]:
    """Return what is to be studied, at the size at which it is."""
    made = []
    for source in sources:
        scene = sized(source.scene, size, MOST_ROWS)
        stated = None if scene.shape == source.scene.shape else scene.shape[:2]
        made.append(Entry(source, scene, scene.path.removeprefix("crosstrace:"), stated))
    return made


def study(todo: Sequence[Entry], options: Options) -> Iterator[Event]:
    """Do it all, filling the entries; gives an event for each step that is done."""
    sides = [side for side in SIDES if side <= options.samples]
    with WorkerPool(1, threads=options.threads) as pool:
        done, total = 0, len(todo) * len(REFERENCES)
        for entry in todo:
            for name in REFERENCES:
                failed = _refer(pool, entry, name, options)
                done += 1
                yield Event(done, total, entry.source.name, name, failed, "references")
            facts = entry.references.get("deep")
            depths = references.depths(entry.scene, facts) if facts else []
            entry.plan = [
                point
                for point in plan(entry.scene, options.lanes, sides, depths)
                if AGAINST[point.kind] in entry.values
            ]
        total = done + sum(len(entry.plan) for entry in todo)
        missing: set[str] = set()
        for entry in todo:
            for point in entry.plan:
                failed = ""
                if point.renderer not in missing:
                    failed = _try(pool, entry, point, options, missing)
                done += 1
                what = f"{point.renderer} {point.label}"
                yield Event(done, total, entry.source.name, what, failed, "timing")
            _find_fronts(entry, options.metric)


def exit_status(done: Sequence[Entry]) -> int:
    """Return 3 where something gave no result."""
    return 3 if any(entry.failures for entry in done) else 0


def _refer(pool: WorkerPool, entry: Entry, name: str, options: Options) -> str:
    """Make a reference; return why there is none, if there was to be one."""
    if name == "deep" and not bounces(entry.scene):
        return ""
    function = getattr(references, name)
    side = 2 * max(options.samples, *FOREIGN_SIDES)
    arguments = (min(side, 64), options.threads) if name == "average" else (options.threads,)
    task = Task(function, "native", timeout_s=options.timeout_s, label=f"the {name} reference")
    try:
        value, facts = pool.submit(task, entry.scene, *arguments).result()
    except CrosstraceError as error:
        entry.failures[f"{name} reference"] = str(error)
        return str(error)
    entry.values[name], entry.references[name] = value, facts
    return ""


def _try(pool: WorkerPool, entry: Entry, point: Point, options: Options, missing: set[str]) -> str:
    """Time a point and measure its error; return why it gave no result."""
    limit = options.timeout_s
    whole = None if limit is None else limit * (options.runs + 2)
    name = f"{point.renderer} {point.label}"
    task = Task(timing.timed, point.renderer, timeout_s=whole, label=name)
    try:
        if point.certify:
            task = replace(task, function=timing.timed_certify)
            made, known = pool.submit(task, entry.scene, options.threads, options.runs).result()
            error = half_widths(known["lo"], known["hi"], ~known["undecidable"])
            _keep(entry, point, made, error, options)
            return ""
        how = point.options(options.threads, limit)
        scene = point.scene(entry.scene)
        made = pool.submit(task, point.renderer, scene, how, options.runs).result()
        _keep_image(pool, entry, point, made, options)
    except RendererMissingError as error:
        missing.add(point.renderer)
        entry.failures[point.renderer] = error.reason
        return error.reason
    except CrosstraceError as error:
        entry.failures[name] = str(error)
        return str(error)
    return ""


def _keep_image(
    pool: WorkerPool, entry: Entry, point: Point, made: timing.Timed, options: Options
) -> None:
    """Measure an image; one of a renderer with rules of its own against these as well."""
    against = entry.values[AGAINST[point.kind]]
    error = measured(made.image, made.low, against)
    own = None
    if point.renderer != "native" and point.kind == "rounding":
        own = _own(pool, entry, point.renderer, options)
    if own is None:
        _keep(entry, point, made, error, options)
        return
    _keep(entry, replace(point, kind="model"), made, error, options)
    _keep(entry, point, made, measured(made.image, made.low, own), options, own_rules=True)


def _own(pool: WorkerPool, entry: Entry, lane: str, options: Options) -> Value | None:
    if lane not in entry.own:
        task = Task(references.own, lane, timeout_s=options.timeout_s, label=f"{lane}'s own rules")
        entry.own[lane] = pool.submit(task, entry.scene, lane, options.threads).result()
    return entry.own[lane]


def _keep(
    entry: Entry, point: Point, made: timing.Timed, error: Error, options: Options,
    own_rules: bool = False,
) -> None:  # fmt: skip
    entry.points.append({
        "scene": entry.source.name,
        "renderer": point.renderer,
        "settings": point.settings,
        "label": point.label,
        "kind": point.kind,
        "against": AGAINST[point.kind],
        "own_rules": own_rules,
        **made.record(options.clock),
        "error": asdict(error),
        "half_step": made.half_step,
        "pareto": False,
        "command": point.command(entry.name, entry.size, options.threads),
    })  # fmt: skip


def _find_fronts(entry: Entry, metric: str) -> None:
    """Mark the points on the front of their kind: errors of different kinds are not mixed."""
    for kind in KINDS:
        some = [
            point
            for point in entry.points
            if point["kind"] == kind
            and not point["own_rules"]
            and point["error"][metric] is not None
        ]
        for i in pareto.front([(point["seconds"], point["error"][metric]) for point in some]):
            some[i]["pareto"] = True
