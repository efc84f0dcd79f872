"""Which job of a run follows which: probe, render, compare as soon as two images are there.

All goes through one Executor. A renderer that is missing, hangs or dies leaves its mark in the
record and takes nothing else down. What the jobs are stands in `orders.py`.
"""

from __future__ import annotations

import queue
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Executor, Future
from dataclasses import dataclass
from functools import partial
from typing import Any

from crosstrace.harness import record
from crosstrace.harness.orders import Job, Orders, Settings
from crosstrace.harness.sources import Source
from crosstrace.translators.errors import (
    RendererError,
    RendererMissingError,
    RendererTimeoutError,
)
from crosstrace.translators.renderer import Probe

#: A lane that hung so often is not asked for the scenes that are left.
_MOST_TIMEOUTS = 2
_GIVEN_UP = RendererError(f"not asked, as it timed out {_MOST_TIMEOUTS} times before")


@dataclass(frozen=True)
class Event:
    """Something that happened in a run.

    `kind` is ``start``, ``progress``, ``done`` or ``failed``; `what` names the work: ``probe`` (of
    no scene; only a failed one is told), ``render``, ``judge`` (all lanes of a scene) or
    ``compare``, for which `lane` names both, as in ``native-povray``. `done` of `total` steps are
    behind it; `fraction` (0…1) is how far a rendering has come.
    """

    kind: str
    scene: str
    lane: str
    what: str
    done: int
    total: int
    message: str = ""
    fraction: float = 0.0


class Session:
    """Scenes through lanes by one executor; `observe` is called in the thread of `run`."""

    def __init__(
        self,
        sources: Sequence[Source],
        settings: Settings,
        executor: Executor,
        observe: Callable[[Event], None],
    ) -> None:
        """Plan; nothing is submitted yet."""
        self._sources, self._settings, self._executor = list(sources), settings, executor
        self._observe = observe
        self._orders, self._lanes = Orders(self._sources, settings), settings.lanes
        self._probes: dict[str, Probe] = {}
        self._rendered: dict[tuple[int, str], dict[str, Any]] = {}
        self._compared: dict[tuple[int, str, str], dict[str, Any]] = {}
        self._judged: dict[int, dict[str, Any]] = {}
        # Answers come from other threads; all bookkeeping is done in one.
        self._inbox: queue.SimpleQueue[Callable[[], None]] = queue.SimpleQueue()
        self._open = self._done = 0
        self._asked: dict[str, list[Future[Any]]] = {lane: [] for lane in self._lanes}
        self._timeouts: Counter[str] = Counter()
        self._pairs = self._orders.pairs
        self._total = len(self._sources) * (len(self._lanes) + len(self._pairs) + 1)

    def run(self) -> dict[str, Any]:
        """Do it all and return the record; it has no times of the whole run yet."""
        for lane in self._lanes:
            self._submit(self._orders.probe(lane), partial(self._on_probe, lane))
        while self._open:
            self._inbox.get()()
        scenes = [self._scene(i) for i in range(len(self._sources))]
        probes = {lane: self._probes[lane] for lane in self._lanes}
        return record.report(scenes, probes, self._settings.record)

    def _submit(self, job: Job, then: Callable[[Future[Any]], None]) -> Future[Any]:
        task, arguments = job
        self._open += 1

        def answered(future: Future[Any]) -> None:
            self._inbox.put(lambda: self._answer(future, then))

        future = self._executor.submit(task, *arguments)
        future.add_done_callback(answered)
        return future

    def _answer(self, future: Future[Any], then: Callable[[Future[Any]], None]) -> None:
        self._open -= 1
        then(future)

    def _on_probe(self, lane: str, future: Future[Any]) -> None:
        error = future.exception()
        probe = Probe(False, reason=record.told(error)) if error else future.result()
        self._probes[lane] = probe
        absence = error or RendererMissingError(probe.reason, probe.remedy)
        if not probe.available:
            # Said once here, and in the record for every scene.
            self._tell("failed", None, lane, "probe", record.told(absence))
        for i in range(len(self._sources)):
            if probe.available:
                self._render(i, lane, probe.version)
            else:
                self._on_rendered(i, lane, record.failed(absence), news=False)

    def _render(self, i: int, lane: str, version: str) -> None:
        def on_progress(fraction: float) -> None:
            self._inbox.put(lambda: self._tell("progress", i, lane, "render", "", fraction))

        def then(future: Future[Any]) -> None:
            error = _GIVEN_UP if future.cancelled() else future.exception()
            if isinstance(error, RendererTimeoutError):
                self._on_timeout(lane)
            self._on_rendered(i, lane, record.failed(error) if error else future.result())

        job = self._orders.render(i, lane, version, on_progress)
        self._asked[lane].append(self._submit(job, then))
        self._tell("start", i, lane, "render")

    def _on_timeout(self, lane: str) -> None:
        self._timeouts[lane] += 1
        if self._timeouts[lane] >= _MOST_TIMEOUTS:
            for future in self._asked[lane]:
                future.cancel()  # of no effect on one that runs or is done

    def _on_rendered(self, i: int, lane: str, made: dict[str, Any], news: bool = True) -> None:
        self._rendered[i, lane] = made
        self._step(i, lane, "render", made["message"] if news else "")
        if all((i, other) in self._rendered for other in self._lanes):
            self._judge(i)
        for a, b in self._pairs:
            if lane in (a, b) and (i, a) in self._rendered and (i, b) in self._rendered:
                self._compare(i, a, b)

    def _judge(self, i: int) -> None:
        made = {lane: self._rendered[i, lane] for lane in self._lanes}
        half_steps = {
            lane: entry["half_step"] for lane, entry in made.items() if entry["status"] == "ok"
        }
        if not half_steps:
            self._on_judged(i, record.not_judged("no image of any renderer"), news=False)
            return

        def then(future: Future[Any]) -> None:
            error = future.exception()
            self._on_judged(i, record.not_judged(record.told(error)) if error else future.result())

        self._submit(self._orders.judge(i, half_steps), then)

    def _on_judged(self, i: int, made: dict[str, Any], news: bool = True) -> None:
        self._judged[i] = made
        self._step(i, "", "judge", made["message"] if news else "")
        self._forget_pixels_once_used(i)

    def _compare(self, i: int, a: str, b: str) -> None:
        without = [lane for lane in (a, b) if self._rendered[i, lane]["status"] != "ok"]
        if without:
            reason = f"no image of {' and '.join(without)}"
            self._on_compared(i, a, b, record.not_compared(reason), news=False)
            return

        def then(future: Future[Any]) -> None:
            error = future.exception()
            made = record.not_compared(record.told(error)) if error else future.result()
            self._on_compared(i, a, b, made)

        self._submit(self._orders.compare(i, a, b), then)

    def _on_compared(self, i: int, a: str, b: str, made: dict[str, Any], news: bool = True) -> None:
        self._compared[i, a, b] = made
        self._step(i, f"{a}-{b}", "compare", made["message"] if news else "")
        self._forget_pixels_once_used(i)

    def _forget_pixels_once_used(self, i: int) -> None:
        if i in self._judged and all((i, *pair) in self._compared for pair in self._pairs):
            self._orders.forget_pixels(i)

    def _step(self, i: int, lane: str, what: str, trouble: str) -> None:
        self._done += 1
        self._tell("failed" if trouble else "done", i, lane, what, trouble, 1.0)

    def _tell(
        self,
        kind: str,
        i: int | None,
        lane: str,
        what: str,
        message: str = "",
        fraction: float = 0.0,
    ) -> None:
        name = "" if i is None else self._sources[i].name
        event = Event(kind, name, lane, what, self._done, self._total, message, fraction)
        self._observe(event)

    def _scene(self, i: int) -> dict[str, Any]:
        renderers = [
            {"name": lane, "version": self._probes[lane].version, **self._rendered[i, lane]}
            for lane in self._lanes
        ]
        pairs: list[Mapping[str, Any]] = [
            {"a": a, "b": b, **self._compared[i, a, b]} for a, b in self._pairs
        ]
        return record.scene(
            self._sources[i], renderers, pairs, self._judged[i], self._settings.options.readings
        )
