"""A study's files: `study.json`, `study.svg`, and a report that shows both."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from crosstrace.harness import images, record
from crosstrace.harness import publish as publishing
from crosstrace.harness.study.experiment import Entry, Options
from crosstrace.harness.study.picture import picture
from crosstrace.translators.renderer import Probe

JSON_NAME, PICTURE_NAME = "study.json", "study.svg"


def publish(
    made: Mapping[str, Any], done: Sequence[Entry], options: Options, directory: Path
) -> None:
    """Write the study's record and picture, and the report with them.

    Raises UsageError where the directory cannot be written.
    """
    drawn = picture(made["points"], options.metric, options.clock)
    with publishing.workspace(directory) as built:
        publishing.publish(built, directory, _report(made, done, options, drawn))
    for name, text in ((JSON_NAME, record.dumps(made)), (PICTURE_NAME, drawn)):
        images.write_bytes(directory / name, text.encode())


def _report(
    made: Mapping[str, Any], done: Sequence[Entry], options: Options, drawn: str
) -> dict[str, Any]:
    """Return a report of no verdicts, whose `study` is this one."""
    run = {
        "readings": {},
        "precision": "f64",
        "threads": options.threads,
        "timeout_s": options.timeout_s,
        "jobs": 1,
    }
    used = {point["renderer"] for entry in done for point in entry.points}
    probes = {
        lane: Probe(lane in used, reason=_reason(lane, done)) for lane in options.lanes
    }  # fmt: skip
    return {**record.report([], probes, run), "study": {**made, "svg": drawn}}


def _reason(lane: str, done: Sequence[Entry]) -> str:
    return next((entry.failures[lane] for entry in done if lane in entry.failures), "")
