"""Scenes measured again: what the main job and the native fingerprint make of them today.

The classes of every pixel are read back from the report's pictures, which hold them losslessly.
"""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Executor, Future
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crosstrace.harness import changes, colormap, fingerprint, goldens, images, outcome, record
from crosstrace.harness.changes import Change
from crosstrace.harness.fingerprint import Difference, Fingerprint
from crosstrace.harness.goldens import Golden, Reference
from crosstrace.harness.jobs import Task, WorkerPool, available_cores
from crosstrace.harness.lanes import REFERENCE
from crosstrace.harness.names import slug
from crosstrace.harness.schedule import Event
from crosstrace.harness.session import RunOptions, run
from crosstrace.harness.sources import Source
from crosstrace.translators.errors import RendererError, UsageError

Observer = Callable[[Event], None]


@dataclass(frozen=True)
class Measured:
    """A scene as it came out today, and its golden if there is one."""

    source: Source
    record: Mapping[str, Any]
    environment: Mapping[str, Any]
    classes: Mapping[str, NDArray[np.uint8]]
    taken: Fingerprint | RendererError
    differences: Sequence[Difference]
    golden: Golden | None

    @property
    def departs(self) -> bool:
        """Whether the verdict is neither good nor what the scene's index expects."""
        return outcome.outcome(self.record) == "departs"

    def changes(self) -> list[Change]:
        """Return what changed since the golden; nothing without one."""
        if self.golden is None:
            return []
        return changes.find(
            self.golden, self.record, self.classes, self.differences, self.environment
        )

    def accepted(self, reason: str) -> Golden:
        """Return today's result, which is complete, as a golden."""
        if isinstance(self.taken, RendererError):
            raise self.taken
        return goldens.made(
            self.record, self.environment, self.taken, self.classes, reason, self.golden
        )

    def absent(self) -> list[dict[str, str]]:
        """Say which lanes left the scene incomplete: those without an image or a judgement."""
        then = self.golden.lanes if self.golden else {}
        lanes = []
        if isinstance(self.taken, RendererError):
            lanes.append(
                {"lane": REFERENCE, "status": "failed", "message": record.told(self.taken)}
            )
        for lane in self.record["renderers"]:
            name, status = lane["name"], lane["status"]
            known = status == "unsupported" == then.get(name, lane)["status"]
            if not known and (status != "ok" or lane["classes"]["equal"] is None):
                status = "not judged" if status == "ok" else status
                why = lane["message"] or self.record["judgement"]["message"]
                lanes.append({"lane": name, "status": status, "message": why})
        return lanes


def measure(
    sources: Sequence[Source],
    reference: Reference,
    options: RunOptions | None,
    out: Path | None,
    events: Observer | None,
    executor: Executor | None,
) -> tuple[dict[str, Any], list[Measured]]:
    """Run scenes and return the record of the run, and each scene beside its golden.

    Raises UsageError, before anything is rendered, for a golden that cannot be read and for scenes
    that have no golden of their own.
    """
    options = options or RunOptions()
    _check_names(sources, reference)
    # Before anything is rendered, and a golden that cannot be read ends it here.
    known = [reference.read(source.name) for source in sources]
    slots = options.jobs or available_cores()
    threads = options.threads or (1 if slots > 1 else 0)
    with ExitStack() as stack:
        scratch = tempfile.TemporaryDirectory(prefix="crosstrace-", ignore_cleanup_errors=True)
        where = Path(stack.enter_context(scratch)) / "report" if out is None else out
        pool = executor or stack.enter_context(WorkerPool(slots, threads=threads))
        # Of the last rank: done where a worker is idle, otherwise at the end.
        task = Task(fingerprint.take_and_compare, "judge", 1 << 30, options.timeout_s,
                    "the native fingerprint")  # fmt: skip
        jobs = [
            pool.submit(task, source.scene, _comparable(golden, source), threads)
            for source, golden in zip(sources, known, strict=True)
        ]
        report = run(sources, where, options, events=events, executor=pool)
        measured = [
            Measured(source, scene, report["environment"], _classes(scene, where),
                      *_fingerprint(job), golden)
            for source, scene, golden, job in zip(
                sources, report["scenes"], known, jobs, strict=True
            )
        ]  # fmt: skip
    return report, measured


def _fingerprint(job: Future[Any]) -> tuple[Fingerprint | RendererError, Sequence[Difference]]:
    try:
        taken, differences = job.result()
    except RendererError as error:
        return error, []
    return taken, differences


def _comparable(golden: Golden | None, source: Source) -> Fingerprint | None:
    same = golden is not None and golden.about["scene"]["sha256"] == source.scene.sha256
    return golden.fingerprint if golden is not None and same else None


def _check_names(sources: Sequence[Source], reference: Reference) -> None:
    """Refuse scenes that would share a golden, and strangers in the packaged folder."""
    if not sources:
        raise UsageError("expected scenes, found none")
    taken: dict[str, str] = {}
    for source in sources:
        name = source.scene.name
        file = slug(name, set()).lower()
        if source.name != name or file in taken:
            other = taken.get(file, name)
            raise UsageError(f"expected one scene a golden, found two: {other} and {source.name}")
        taken[file] = name
        if reference.packaged and not is_packaged(source):
            raise UsageError(
                f"{name}: expected --reference with a folder for the goldens of your own scenes"
            )


def _classes(scene: Mapping[str, Any], root: Path) -> dict[str, NDArray[np.uint8]]:
    """Read the classes of every judged lane back from the report's pictures."""
    found = {}
    for lane in scene["renderers"]:
        if lane["classes"]["equal"] is None:
            continue
        picture = lane["images"].get("classes")
        if picture is None:
            found[lane["name"]] = np.zeros((scene["v_res"], scene["h_res"]), np.uint8)
        else:
            pixels = np.rint(images.read(root / picture["file"]) * 255).astype(np.uint8)
            found[lane["name"]] = colormap.classes_of_picture(pixels)
    return found


def is_packaged(source: Source) -> bool:
    """Say whether a scene came with this package, so that its index says what is expected."""
    return source.scene.path.startswith("crosstrace:")
