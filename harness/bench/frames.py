"""Whole frames of every lane on all cores, as the report times them.

That is without start-up, but for POV-Ray's, which is a program of its own: by wall clock in worker
processes, into memory that is new in every frame.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from crosstrace.harness import alone
from crosstrace.harness.bench import rows
from crosstrace.harness.bench.runs import Runs
from crosstrace.harness.lanes import LANES, REFERENCE
from crosstrace.harness.sources import Source
from crosstrace.translators.errors import CrosstraceError
from crosstrace.translators.renderer import RenderOptions


def measure(
    source: Source, repeat: int, timeout_s: float, told: Callable[[float], None]
) -> list[dict[str, Any]]:
    """Return a row for every lane but native, which is held against it."""
    runs = {lane: Runs() for lane in LANES}
    how = RenderOptions(timeout_s=timeout_s)
    for turn in range(repeat + 1):
        for k, lane in enumerate(LANES):
            told((turn + k / len(LANES)) / (repeat + 1))
            if runs[lane].status != "ok":
                continue
            try:
                if turn == 0 and not (probe := alone.probe(lane)).available:
                    runs[lane].fail("missing", probe.reason)
                    continue
                frame, _ = alone.render(lane, source.scene, how)
            except CrosstraceError as error:
                runs[lane].fail("failed", error)
                continue
            if turn > 0:
                runs[lane].values.append(frame.seconds.render)
    ours = runs.pop(REFERENCE)
    return [rows.frame(source.name, lane, ours, theirs) for lane, theirs in runs.items()]
