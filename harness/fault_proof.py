"""The suite proves itself: a record of which planted faults are caught, and what it means.

Every fault of the catalogue is planted in every lane on every scene (`mutation.rows`), and judged
as a run is. A fault that changes more than a few pixels and is not caught, or is blamed on anybody
but its lane, has escaped; one escape fails the proof.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from datetime import UTC, datetime
from typing import Any, Literal

from crosstrace.harness import mutation, outcome
from crosstrace.harness.environment import describe
from crosstrace.harness.faults import FAULTS, Fault
from crosstrace.harness.jobs import WorkerPool, available_cores
from crosstrace.harness.mutation import Row
from crosstrace.harness.session import RunOptions
from crosstrace.harness.sources import Source, sized
from crosstrace.translators.renderer import RenderOptions

SCHEMA = "crosstrace-mutation/1"

#: Rows of a larger scene by default: a scene is rendered some ninety times.
MOST_ROWS = 60

#: Takes how many rows are done, how many there are, and the last one.
Observer = Callable[[int, int, Row], None]

State = Literal["nothing", "too little", "caught", "escaped", "failed"]


def prove(
    sources: Sequence[Source],
    options: RunOptions | None = None,
    *,
    faults: Sequence[Fault] = FAULTS,
    events: Observer | None = None,
) -> dict[str, Any]:
    """Plant the faults in the lanes of the options; return the record, one row a planting.

    Scenes of more than `MOST_ROWS` rows are reduced to so many unless the options have a size.
    """
    options = options or RunOptions()
    started = time.perf_counter()
    todo = [replace(it, scene=sized(it.scene, options.size, MOST_ROWS)) for it in sources]
    total = len(todo) * sum(lane in fault.lanes for lane in options.lanes for fault in faults)
    how = RenderOptions(threads=1, timeout_s=options.timeout_s)
    made: list[Row] = []
    with WorkerPool(options.jobs or available_cores(), threads=1) as pool:
        for row in mutation.rows(
            todo, pool, faults=faults, lanes=options.lanes, options=how,
            judge=mutation.Court(options.threads),
        ):  # fmt: skip
            made.append(row)
            if events is not None:
                events(len(made), total, row)
    scenes = [_scene(source, [row for row in made if row.scene == source.name]) for source in todo]
    return {
        "schema": SCHEMA,
        "status": _status(made),
        "created": datetime.now(UTC).isoformat(timespec="seconds"),
        "seconds": time.perf_counter() - started,
        "lanes": list(options.lanes),
        "faults": {fault.name: fault.sentence for fault in faults},
        "environment": describe(),
        "scenes": scenes,
        "rows": [row.record() for row in made],
    }


def state(row: Mapping[str, Any]) -> State:
    """Say what became of a planting: there was nothing to break, it was caught, it escaped …"""
    if row["error"] is not None:
        return "failed"
    if row["changed"] is None:
        return "nothing"
    if row["caught"] is None:
        return "too little"
    return "caught" if row["caught"] and row["blamed"] else "escaped"


def exit_status(record: Mapping[str, Any]) -> int:
    """Return 1 where a fault escaped, 3 where a lane failed to render or nothing was judged."""
    return outcome.EXIT_STATUS[record["status"]]


def _status(made: Sequence[Row]) -> str:
    states = {state(row.record()) for row in made}
    if "escaped" in states:
        return "fail"
    return "pass" if "caught" in states and "failed" not in states else "incomplete"


def _scene(source: Source, made: Sequence[Row]) -> dict[str, Any]:
    judged = [row for row in made if row.caught is not None]
    return {
        "name": source.name,
        "sha256": source.scene.sha256,
        "size": [source.scene.v_res, source.scene.h_res],
        "judged": len(judged),
        "caught": sum(bool(row.caught) for row in judged),
        "blamed": sum(bool(row.blamed) for row in judged),
    }
