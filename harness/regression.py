"""The regression suite: scenes rendered again and held against their goldens.

`check` compares, `bless` accepts. Both run the main job (`session.run`), with its workers, and have
one more job a scene for the native fingerprint. A scene without a golden fails its check, after a
golden was made, unless its verdict needs somebody's reason first.
"""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Executor, Future
from contextlib import ExitStack
from dataclasses import asdict, dataclass
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

SCHEMA = "crosstrace-check/1"

#: The reason of a golden that a check has made.
CREATED = "made by a check, as there was none"

Observer = Callable[[Event], None]


@dataclass(frozen=True)
class _Measured:
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


def check(
    sources: Sequence[Source],
    reference: Reference,
    options: RunOptions | None = None,
    *,
    out: Path | None = None,
    events: Observer | None = None,
    executor: Executor | None = None,
) -> dict[str, Any]:
    """Render scenes again and compare them with their goldens; return the record of the check.

    `out` keeps the report of the run, `executor` is as for `session.run`. A golden that is missing
    is made where the folder can be written, and the check fails all the same. Raises UsageError for
    a golden that cannot be read.
    """
    report, measured = _measure(sources, reference, options, out, events, executor)
    scenes = [_checked(one, reference) for one in measured]
    statuses = {scene["status"] for scene in scenes}
    status = next(word for word in ("fail", "incomplete", "pass") if word in statuses)
    return {
        "schema": SCHEMA,
        "status": status,
        "created": report["run"]["created"],
        "seconds": report["run"]["seconds"],
        "lanes": report["run"]["lanes"],
        "environment": report["environment"],
        "scenes": scenes,
    }


def exit_status(checked: Mapping[str, Any]) -> int:
    """Return 0 for a check that passed, 1 for one that failed, 3 for an incomplete one."""
    by_word = {
        "pass": outcome.OK, "fail": outcome.DISAGREES, "incomplete": outcome.RENDERER_FAILED,
    }  # fmt: skip
    return by_word[checked["status"]]


def bless(
    sources: Sequence[Source],
    reference: Reference,
    reason: str,
    options: RunOptions | None = None,
    *,
    events: Observer | None = None,
    executor: Executor | None = None,
) -> list[dict[str, Any]]:
    """Render scenes and accept what comes out as their goldens; return what was done to each.

    A scene that came out as its golden says is left alone; one that is incomplete, or speaks
    against the reference, cannot be accepted. Raises UsageError without a reason.
    """
    if not (reason := " ".join(reason.split())):
        raise UsageError("expected a reason for accepting new results, found none")
    reference.check_writable()
    _, measured = _measure(sources, reference, options, None, events, executor)
    return [_blessed(one, reference, reason) for one in measured]


def told(absent: Sequence[Mapping[str, str]]) -> str:
    """Say in a line which lanes are absent and why."""
    return "; ".join(f"{lane['lane']} {lane['status']}: {lane['message']}" for lane in absent)


def _blessed(one: _Measured, reference: Reference, reason: str) -> dict[str, Any]:
    found = one.changes()
    done: dict[str, Any] = {
        "name": one.source.name,
        "verdict": one.record["verdict"],
        "blame": list(one.record["blame"]),
        "changes": [asdict(change) for change in found],
        "bytes": None,
    }
    if absent := one.absent():
        return {**done, "status": "incomplete", "message": told(absent)}
    if one.record["verdict"] == "reference-broken":
        return {**done, "status": "refused", "message": outcome.sentence(one.record)}
    # What a check made has no reason yet.
    if one.golden is not None and not found and one.golden.reason != CREATED:
        return {**done, "status": "unchanged", "message": one.golden.reason}
    size = reference.write(one.source.name, one.accepted(reason))
    return {**done, "status": "blessed" if one.golden else "new", "message": reason, "bytes": size}


def _checked(one: _Measured, reference: Reference) -> dict[str, Any]:
    absent = one.absent()
    if one.golden is None:
        found = [_missing_golden(one, reference, absent)]
    else:
        found = one.changes()
        # A scene without an index is to be as it was accepted, whatever that was.
        if one.departs and _is_packaged(one.source):
            found.insert(0, Change("verdict", _departure(one.record), True))
    fails = any(change.fails for change in found)
    return {
        "name": one.source.name,
        "sha256": one.record["sha256"],
        "status": "fail" if fails else "incomplete" if absent else "pass",
        "verdict": one.record["verdict"],
        "blame": list(one.record["blame"]),
        "sentence": outcome.sentence(one.record),
        "reason": one.golden.reason if one.golden else None,
        "absent": absent,
        "changes": [asdict(change) for change in found],
        "renderers": [
            {
                "name": lane["name"],
                "version": lane["version"],
                "status": lane["status"],
                "seconds": sum(value or 0.0 for value in lane["seconds"].values()),
                "classes": dict(lane["classes"]),
            }
            for lane in one.record["renderers"]
        ],
    }


def _missing_golden(one: _Measured, reference: Reference, absent: Sequence[Any]) -> Change:
    """Make a golden of a scene that has none, if nobody has to answer for it."""
    if absent:
        text = "there is no golden, and none can be made without every renderer"
    elif one.departs:
        text = (
            f"there is no golden, and the verdict is {one.record['verdict']}: accept it with "
            "`crosstrace bless` and a reason, or not at all"
        )
    else:
        try:
            reference.write(one.source.name, one.accepted(CREATED))
            text = "there was no golden: one was made, look at it and keep it under version control"
        except UsageError as error:
            text = f"there is no golden: {error}"
    return Change("golden", text, True)


def _departure(scene: Mapping[str, Any]) -> str:
    expected = outcome.applying(scene)
    wanted = "agree or explained" if expected is None else expected["verdict"]
    return f"the scene's index expects {wanted}, found {scene['verdict']}"


def _is_packaged(source: Source) -> bool:
    return source.scene.path.startswith("crosstrace:")


def _measure(
    sources: Sequence[Source],
    reference: Reference,
    options: RunOptions | None,
    out: Path | None,
    events: Observer | None,
    executor: Executor | None,
) -> tuple[dict[str, Any], list[_Measured]]:
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
            _Measured(source, scene, report["environment"], _classes(scene, where),
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
        if reference.packaged and not _is_packaged(source):
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
