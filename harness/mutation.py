"""The mutation test: every fault planted in every lane on every scene, and whether it is caught.

A suite that never fails proves nothing. Here each lane in turn renders with a fault of the
catalogue while the others stay honest; a judge sees the renderings of one scene and says whether
the difference is caught and blamed on the lane that has the fault.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import Executor, Future
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

from crosstrace.harness import tasks
from crosstrace.harness.faults import FAULTS, Fault, changed_pixels
from crosstrace.harness.faults.apart import planted
from crosstrace.harness.jobs import Task
from crosstrace.harness.lanes import LANES
from crosstrace.harness.sources import Source
from crosstrace.translators.errors import RendererError, SceneError
from crosstrace.translators.renderer import Rendering, RenderOptions

if TYPE_CHECKING:
    from crosstrace.translators.native.truth import Enclosures

#: A fault that changes no more pixels than this need not be caught.
CHANGED_ENOUGH = 20

#: Takes a scene, one rendering a lane and the lane that has the fault, "" for none; returns whether
#: the disagreement is caught, and whether it is blamed on that lane and no other. `Court` is one.
Judge = Callable[[Source, Mapping[str, Rendering], str], tuple[bool, bool]]


class Court:
    """The judge of a run: caught is any bad verdict, blamed is that lane and no other."""

    def __init__(self, threads: int = 0) -> None:
        """Begin with no truth known; that of a scene is kept for the next fault in it."""
        self._threads = threads
        self._scene = ""
        self._known: Enclosures | None = None

    def __call__(
        self, source: Source, made: Mapping[str, Rendering], lane: str
    ) -> tuple[bool, bool]:
        """Judge the renderings of one scene of which `lane` has a fault."""
        from crosstrace.harness import judging
        from crosstrace.harness.outcome import GOOD

        known = self._known if self._scene == source.scene.sha256 else None
        lanes = {name: (it.image, it.half_step) for name, it in made.items()}
        found = judging.judge(source.scene, lanes, threads=self._threads, known=known)
        self._scene, self._known = source.scene.sha256, found.known
        return found.verdict.word not in GOOD, found.verdict.blame == (lane,)


#: What a lane may answer; a wrong name is the caller's mistake, and raised.
_FAILURES = (RendererError, SceneError)


@dataclass(frozen=True)
class Row:
    """One fault in one lane on one scene.

    `changed` counts the pixels beyond the lane's own noise, None where the scene has nothing to
    break or a rendering failed (`error` says how). `caught` and `blamed` are None where nobody
    judged: without a judge, or where too little changed.
    """

    scene: str
    lane: str
    fault: str
    kind: str
    changed: int | None = None
    caught: bool | None = None
    blamed: bool | None = None
    error: str | None = None

    def record(self) -> dict[str, Any]:
        """Return the row, ready for JSON."""
        return asdict(self)


def rows(
    sources: Iterable[Source],
    executor: Executor,
    *,
    faults: Sequence[Fault] = FAULTS,
    lanes: Sequence[str] = LANES,
    options: RenderOptions | None = None,
    judge: Judge | None = None,
) -> Iterator[Row]:
    """Plant the faults, scene by scene and lane by lane, in the order of the arguments.

    Every image is rendered through the executor; `options.timeout_s` bounds each. The images of one
    lane and scene are in memory together. A scene of which the judge catches the honest renderings
    proves nothing of faults: its rows have that as their error.
    """
    options = options or RenderOptions(threads=1, timeout_s=120.0)
    for source in sources:
        honest = _honest(source, executor, lanes, options)
        made = {lane: it for lane, it in honest.items() if isinstance(it, Rendering)}
        if judge is not None and made and judge(source, made, "")[0]:
            yield from (
                _row(source, fault, lane, error="without a fault: the lanes disagree")
                for lane in lanes
                for fault in faults
                if lane in fault.lanes
            )
            continue
        for lane in lanes:
            yield from _of_lane(source, executor, faults, lane, options, honest, judge)


def _honest(
    source: Source, executor: Executor, lanes: Sequence[str], options: RenderOptions
) -> dict[str, Rendering | RendererError | SceneError]:
    waiting = {}
    for lane in lanes:
        task = Task(tasks.render, lane, timeout_s=options.timeout_s, label=lane)
        waiting[lane] = executor.submit(task, lane, source.scene, options)
    made = {lane: _outcome(future) for lane, future in waiting.items()}
    # The worker adds the peak memory, which says nothing here.
    return {lane: it[0] if isinstance(it, tuple) else it for lane, it in made.items()}


def _of_lane(
    source: Source,
    executor: Executor,
    faults: Sequence[Fault],
    lane: str,
    options: RenderOptions,
    honest: Mapping[str, Rendering | RendererError | SceneError],
    judge: Judge | None,
) -> Iterator[Row]:
    mine = [fault for fault in faults if lane in fault.lanes]
    before = honest[lane]
    if isinstance(before, _FAILURES):
        yield from (_row(source, fault, lane, error=f"without a fault: {before}") for fault in mine)
        return
    waiting: list[Future[Any]] = [
        executor.submit(planted(fault.name, lane, options), fault.name, lane, source.scene, options)
        for fault in mine
    ]
    # An image is let go as soon as its row is written.
    waiting.reverse()
    others = {name: made for name, made in honest.items() if isinstance(made, Rendering)}
    for fault in mine:
        made = _outcome(waiting.pop())
        if isinstance(made, _FAILURES):
            yield _row(source, fault, lane, error=str(made))
        elif made is None:
            yield _row(source, fault, lane)
        else:
            changed = changed_pixels(lane, before, made)
            caught = blamed = None
            if judge is not None and changed > CHANGED_ENOUGH:
                caught, blamed = judge(source, {**others, lane: made}, lane)
            yield _row(source, fault, lane, changed=changed, caught=caught, blamed=blamed)


def _row(source: Source, fault: Fault, lane: str, **known: Any) -> Row:
    return Row(source.name, lane, fault.name, fault.kind(lane), **known)


def _outcome(future: Future[Any]) -> Any:
    """Return what was rendered, or the error of a lane that did not render."""
    try:
        return future.result()
    except _FAILURES as error:
        return error
