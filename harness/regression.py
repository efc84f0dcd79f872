"""The regression suite: scenes rendered again and held against their goldens.

`check` compares, `bless` accepts. Both run the main job (`session.run`), with its workers, and have
one more job a scene for the native fingerprint. A scene without a golden fails its check, after a
golden was made, unless its verdict needs somebody's reason first.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import asdict
from pathlib import Path
from typing import Any

from crosstrace.harness import outcome, verdict_table
from crosstrace.harness.changes import Change
from crosstrace.harness.goldens import Reference
from crosstrace.harness.remeasure import Measured, Observer, is_packaged, measure
from crosstrace.harness.session import RunOptions
from crosstrace.harness.sources import Source, all_packaged_names
from crosstrace.translators.errors import UsageError

SCHEMA = "crosstrace-check/1"

#: The reason of a golden that a check has made.
CREATED = "made by a check, as there was none"


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
    report, measured = measure(sources, reference, options, out, events, executor)
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
    return outcome.EXIT_STATUS[checked["status"]]


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
    _, measured = measure(sources, reference, options, None, events, executor)
    done = [_blessed(one, reference, reason) for one in measured]
    if any(scene["bytes"] for scene in done):
        verdict_table.write(reference, list(all_packaged_names()))
    return done


def told(absent: Sequence[Mapping[str, str]]) -> str:
    """Say in a line which lanes are absent and why."""
    return "; ".join(f"{lane['lane']} {lane['status']}: {lane['message']}" for lane in absent)


def _blessed(one: Measured, reference: Reference, reason: str) -> dict[str, Any]:
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


def _checked(one: Measured, reference: Reference) -> dict[str, Any]:
    absent = one.absent()
    if one.golden is None:
        found = [_missing_golden(one, reference, absent)]
    else:
        found = one.changes()
        # A scene of which no index speaks is to be as it was accepted, whatever that was.
        if one.departs and (is_packaged(one.source) or one.source.expected):
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


def _missing_golden(one: Measured, reference: Reference, absent: Sequence[Any]) -> Change:
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
