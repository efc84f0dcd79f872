"""The jobs of a run: which task does a step, with which arguments, and where its files are.

Jobs are ranked so that pictures appear scene by scene, and a comparison goes before further
renderings, so that scratch files do not pile up.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from pathlib import Path
from typing import Any

from crosstrace.harness import judging, store, tasks
from crosstrace.harness.environment import package_version
from crosstrace.harness.jobs import Task
from crosstrace.harness.lanes import REFERENCE
from crosstrace.harness.names import slug
from crosstrace.harness.sources import Source
from crosstrace.translators.renderer import RenderOptions

#: A task, and the arguments to submit it with.
Job = tuple[Task, tuple[Any, ...]]

#: A renderer that cannot say within this time whether it works does not.
_PROBE_TIMEOUT_S = 60.0

#: A renderer's own time limit gives the better message, so the worker's comes later.
_GRACE_S = 5.0


@dataclass(frozen=True)
class Settings:
    """Where a session leaves its files and how it renders.

    `root` is the directory of the report, `pixels` one for float64 images, both seen by every
    worker. `options` go to every lane, its readings and its precision to the reference alone.
    `tolerance` widens what counts as equal, on linear float.
    """

    lanes: tuple[str, ...]
    root: Path
    pixels: Path
    options: RenderOptions
    timeout_s: float | None = None
    tolerance: float = 0.0

    @property
    def record(self) -> dict[str, Any]:
        """What a record says of them."""
        return {
            "readings": dict(self.options.readings),
            "precision": self.options.precision,
            "threads": self.options.threads,
            "timeout_s": self.timeout_s,
            "tolerance": self.tolerance,
        }


class Orders:
    """Makes the jobs for scenes by number and lanes by name; submits nothing."""

    def __init__(self, sources: Sequence[Source], settings: Settings) -> None:
        """Give every scene a folder and every lane a file name of its own."""
        self._sources, self._settings = sources, settings
        taken: set[str] = set()
        self._folders = [slug(source.name, taken) for source in sources]
        taken_lanes: set[str] = set()
        self._files = {lane: slug(lane, taken_lanes) for lane in settings.lanes}
        self.pairs = tuple(combinations(settings.lanes, 2))

    def probe(self, lane: str) -> Job:
        """Ask whether a lane works."""
        return Task(tasks.probe, lane, timeout_s=_PROBE_TIMEOUT_S, label=lane), (lane,)

    def render(self, i: int, lane: str, version: str, on_progress: Callable[[float], None]) -> Job:
        """Render a scene, scenes in their order."""
        settings, limit = self._settings, self._settings.timeout_s
        options = replace(settings.options, timeout_s=limit)
        if lane != REFERENCE:
            options = replace(options, readings={}, precision="f64")
        task = Task(
            store.render_to_files,
            affinity=lane,
            rank=i,
            timeout_s=None if limit is None else limit + _GRACE_S,
            label=lane,
            on_progress=on_progress,
        )
        scene, place = self._sources[i].scene, self._place(i, self._files[lane])
        return task, (lane, scene, options, version, self._pixels(i, lane), place)

    def judge(self, i: int, half_steps: Mapping[str, float]) -> Job:
        """Judge the images of a scene, given by lane with the half steps of their outputs."""
        settings = self._settings
        exhibits = [
            judging.Exhibit(lane, self._pixels(i, lane), half_step + settings.tolerance)
            for lane, half_step in half_steps.items()
        ]
        places = {lane: self._place(i, file) for lane, file in self._files.items()}
        readings, threads = dict(settings.options.readings), settings.options.threads
        task = Task(
            judging.judge_files, "judge", rank=-1, timeout_s=settings.timeout_s, label="judging"
        )
        # No lane's file can be called so.
        common = self._place(i, "_scene")
        scene = self._sources[i].scene
        return task, (scene, readings, exhibits, threads, places, package_version(), common)

    def compare(self, i: int, a: str, b: str) -> Job:
        """Measure how far two images of a scene are apart."""
        task = Task(
            store.compare_files,
            affinity="compare",
            rank=-1,
            timeout_s=self._settings.timeout_s,
            label=f"the comparison of {a} with {b}",
        )
        place = self._place(i, f"{self._files[a]}-{self._files[b]}")
        return task, (self._pixels(i, a), self._pixels(i, b), place, package_version())

    def forget_pixels(self, i: int) -> None:
        """Remove the float64 images of a scene."""
        for lane in self._files:
            self._pixels(i, lane).unlink(missing_ok=True)

    def _pixels(self, i: int, lane: str) -> Path:
        return self._settings.pixels / f"{i}-{self._files[lane]}.npy"

    def _place(self, i: int, stem: str) -> store.Place:
        return store.Place(self._settings.root, f"images/{self._folders[i]}/{stem}")
