"""The measurements of `crosstrace bench`, in the order that keeps a comparison fair.

All that is compared is measured in one run, one after the other in every turn, so that whatever
else the machine does meets both sides; a first turn warms kernels, caches and pages and does not
count. Rows hold medians, and every run is kept. What fails is a row that says so.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from crosstrace.harness import alone
from crosstrace.harness.bench import frames, intersection, native_frames, rows, spheres
from crosstrace.harness.jobs import Task
from crosstrace.harness.sources import Source
from crosstrace.translators.errors import CrosstraceError

#: Scenes, size and numbers of spheres, unless asked otherwise.
SCENES, SIZE = ("glass-bench", "phong-bench", "vidro4"), (1080, 1920)
SPHERES = (1_000, 100_000, 1_000_000)

#: A limit is of one frame, and what runs in a worker is about so many of them in every turn.
_FRAMES_A_TURN = 8

Told = Callable[[float, str], None]


def bench(
    sources: Sequence[Source],
    crowds: Sequence[int],
    repeat: int,
    timeout_s: float,
    told: Told,
) -> dict[str, Any]:
    """Measure scenes and crowds of spheres.

    Returns the record: `machine`, `settings` and `rows`, JSON-ready.
    """
    from crosstrace.harness.environment import describe

    made: list[dict[str, Any]] = []
    total = len(sources) + len(crowds)

    def in_a_worker(
        affinity: str, function: Callable[..., Any], name: str, *args: Any
    ) -> list[dict[str, Any]]:
        limit_s = timeout_s * _FRAMES_A_TURN * (repeat + 1)
        task = Task(function, affinity, timeout_s=limit_s, label="measuring")
        try:
            found: list[dict[str, Any]] = alone.call(task, name, *args, repeat)
        except CrosstraceError as error:
            return [rows.failed(name, error)]
        return found

    for i, source in enumerate(sources):

        def part(share: float, begin: int = i, name: str = source.name) -> None:
            told((begin + share) / total, name)

        part(0.0)
        made += in_a_worker("bench", native_frames.measure, source.name, source.scene)
        part(0.3)
        made += frames.measure(source, repeat, timeout_s, lambda share: part(0.3 + 0.5 * share))
        made += in_a_worker("bench", intersection.measure, source.name, source.scene)
    for i, n in enumerate(crowds, len(sources)):
        name = spheres.name_of(n)
        told(i / total, name)
        made += in_a_worker(name, spheres.measure, name, n)
    told(1.0, "")
    settings = {
        "scenes": [source.name for source in sources],
        "spheres": list(crowds),
        "size": [[source.scene.v_res, source.scene.h_res] for source in sources],
        "repeat": repeat,
    }
    return {"machine": describe(), "settings": settings, "rows": made}
