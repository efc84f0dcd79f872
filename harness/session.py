"""The main job: every scene through every lane, every two images compared, one record.

Work goes to an Executor and comes back as small records; images lie in files. A lane that is
missing, hangs, dies or refuses is recorded with its message and the rest goes on.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable
from concurrent.futures import FIRST_COMPLETED, Executor, Future, wait
from dataclasses import dataclass, field, replace
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from crosstrace.harness import record, store, tasks
from crosstrace.harness.environment import package_version
from crosstrace.harness.jobs import Task
from crosstrace.harness.names import slug
from crosstrace.harness.sources import Source
from crosstrace.translators.errors import (
    CrosstraceError,
    RendererMissingError,
    UnsupportedSceneError,
)
from crosstrace.translators.renderer import Probe, RenderOptions

#: A lane that has not said within this time whether it works does not.
PROBE_TIMEOUT_S = 120.0

Pair = tuple[str, str]


@dataclass(frozen=True)
class Event:
    """Something that is done: `done` of `total` jobs, with a line for people."""

    done: int
    total: int
    text: str
    failed: bool = False


@dataclass(frozen=True)
class Settings:
    """How a run is done; `root` receives the images, `pixels` is a scratch directory."""

    lanes: tuple[str, ...]
    root: Path
    pixels: Path
    options: RenderOptions = RenderOptions()
    timeout_s: float | None = None
    observe: Callable[[Event], None] = lambda event: None


@dataclass
class _SceneRun:
    """What is known of one scene so far; `rank` is its place in the queue."""

    source: Source
    rank: int
    folder: str
    renderers: dict[str, dict[str, Any]] = field(default_factory=dict)
    pairs: dict[Pair, dict[str, Any]] = field(default_factory=dict)


class Session:
    """One run of some scenes through some lanes."""

    def __init__(self, sources: list[Source], settings: Settings, executor: Executor) -> None:
        """Prepare; nothing is submitted before `run`."""
        self._settings, self._executor = settings, executor
        folders: set[str] = set()
        self._scenes = [
            _SceneRun(source, rank, f"images/{slug(source.name, folders)}")
            for rank, source in enumerate(sources)
        ]
        file_names: set[str] = set()
        self._file_names = {lane: slug(lane, file_names) for lane in settings.lanes}
        self._pairs = list(itertools.combinations(settings.lanes, 2))
        self._pending: dict[Future[Any], Callable[[Future[Any]], None]] = {}
        self._probes: dict[str, Probe] = {}
        self._failed_probes: set[str] = set()
        self._done = 0
        per_scene = len(settings.lanes) + len(self._pairs)
        self._total = len(settings.lanes) + per_scene * len(sources)

    def run(self) -> dict[str, Any]:
        """Do everything and return the record of `record.report`."""
        lanes = self._settings.lanes
        for lane in lanes:
            self._probe(lane)
        while self._pending:
            finished, _ = wait(self._pending, return_when=FIRST_COMPLETED)
            for future in finished:
                self._pending.pop(future)(future)
        about = {
            "created": datetime.now(UTC).isoformat(timespec="seconds"),
            "lanes": list(lanes),
            "timeout_s": self._settings.timeout_s,
        }
        entries = [self._entry(scene) for scene in self._scenes]
        return record.report(entries, {lane: self._probes[lane] for lane in lanes}, about)

    def _submit(self, task: Task, *args: Any, then: Callable[[Future[Any]], None]) -> None:
        self._pending[self._executor.submit(task, *args)] = then

    def _tell(self, text: str, failed: bool = False) -> None:
        self._done += 1
        self._settings.observe(Event(self._done, self._total, text, failed))

    def _probe(self, lane: str) -> None:
        def handle(future: Future[Any]) -> None:
            try:
                probe: Probe = future.result()
            except Exception as error:
                probe = Probe(False, reason=message(error))
                self._failed_probes.add(lane)
            self._probes[lane] = probe
            self._tell(f"{lane} {probe.version or 'is missing'}", not probe.available)
            for scene in self._scenes:
                if probe.available:
                    self._render(scene, lane)
                else:
                    self._rendered(scene, lane, self._absence(lane))

        label = f"{lane}: looking for it"
        task = Task(tasks.probe, lane, rank=-1, timeout_s=PROBE_TIMEOUT_S, label=label)
        self._submit(task, lane, then=handle)

    def _absence(self, lane: str) -> dict[str, str]:
        probe = self._probes[lane]
        if lane in self._failed_probes:
            return record.failure("failed", probe.reason)
        return record.failure("missing", str(RendererMissingError(probe.reason, probe.remedy)))

    def _render(self, scene: _SceneRun, lane: str) -> None:
        def handle(future: Future[Any]) -> None:
            try:
                result = future.result()
            except Exception as error:
                result = record.failure(_status(error), message(error))
            self._rendered(scene, lane, result)

        limit = self._settings.timeout_s
        place = store.Place(self._settings.root, f"{scene.folder}/{self._file_names[lane]}")
        options = replace(self._settings.options, timeout_s=limit)
        version, pixels = self._probes[lane].version, self._pixels(scene, lane)
        task = Task(store.render_to_files, lane, rank=scene.rank, timeout_s=limit, label=lane)
        self._submit(task, lane, scene.source.scene, options, version, pixels, place, then=handle)

    def _rendered(self, scene: _SceneRun, lane: str, result: dict[str, Any]) -> None:
        entry = record.renderer_entry(lane, self._probes[lane].version, result)
        scene.renderers[lane] = entry
        failed = entry["status"] != "ok"
        note = f": {entry['message']}" if failed else f", {entry['seconds']['render']:.2f} s"
        self._tell(f"{scene.source.name} by {lane} {entry['status']}{note}", failed)
        if not self._pairs:
            self._forget_pixels(scene)
        for a, b in self._pairs:
            if lane in (a, b) and a in scene.renderers and b in scene.renderers:
                self._compare(scene, (a, b))

    def _compare(self, scene: _SceneRun, pair: Pair) -> None:
        def handle(future: Future[Any]) -> None:
            try:
                result = future.result()
            except Exception as error:
                result = {"message": message(error)}
            self._compared(scene, pair, result)

        if any(scene.renderers[lane]["status"] != "ok" for lane in pair):
            self._compared(scene, pair, {"message": "one of the images is missing"})
            return
        a, b = pair
        stem = f"{scene.folder}/{self._file_names[a]}-vs-{self._file_names[b]}"
        place = store.Place(self._settings.root, stem)
        label = f"comparing {a} with {b}"
        task = Task(store.compare_files, "compare", rank=scene.rank, label=label)
        pixels = [self._pixels(scene, lane) for lane in pair]
        self._submit(task, *pixels, place, package_version(), then=handle)

    def _compared(self, scene: _SceneRun, pair: Pair, result: dict[str, Any]) -> None:
        scene.pairs[pair] = entry = record.pair_entry(*pair, result)
        if len(scene.pairs) == len(self._pairs):
            self._forget_pixels(scene)
        what = entry["message"] or f"greatest difference {entry['max']:.2g}"
        self._tell(f"{scene.source.name}: {pair[0]} with {pair[1]}, {what}")

    def _pixels(self, scene: _SceneRun, lane: str) -> Path:
        return self._settings.pixels / f"{scene.rank}-{self._file_names[lane]}.npy"

    def _forget_pixels(self, scene: _SceneRun) -> None:
        for lane in self._settings.lanes:
            self._pixels(scene, lane).unlink(missing_ok=True)

    def _entry(self, scene: _SceneRun) -> dict[str, Any]:
        renderers = [scene.renderers[lane] for lane in self._settings.lanes]
        return record.scene_entry(scene.source, renderers, [scene.pairs[p] for p in self._pairs])


def message(error: Exception) -> str:
    """Return the text of an error for a record: a foreign one with its type."""
    return str(error) if isinstance(error, CrosstraceError) else f"{type(error).__name__}: {error}"


def _status(error: Exception) -> str:
    if isinstance(error, RendererMissingError):
        return "missing"
    return "unsupported" if isinstance(error, UnsupportedSceneError) else "failed"
