"""One call of a lane at a time, in a worker process: a crash there cannot take the caller down.

The workers stay warm between calls, so a lane's start-up is paid once; they end with this process.
"""

from __future__ import annotations

import os
import threading
from collections.abc import Iterable, Iterator, Mapping
from concurrent.futures import as_completed
from pathlib import Path
from typing import TYPE_CHECKING, Any

from numpy.typing import NDArray

from crosstrace.harness import tasks
from crosstrace.harness.jobs import Task, WorkerPool, available_cores
from crosstrace.translators.renderer import Probe, Progress, Rendering, RenderOptions, Translation
from crosstrace.translators.scene import Scene

if TYPE_CHECKING:
    from crosstrace.harness.display import DisplayRule
    from crosstrace.translators.native.explain import PixelTree
    from crosstrace.translators.native.truth import Enclosures

#: A colour, and the half width of its quantisation.
Pixel = tuple[tuple[float, float, float], float]

Layers = dict[str, NDArray[Any]]

#: An image that takes longer is given up, unless another limit is stated.
TIMEOUT_S = 300.0

#: A lane that has not said within this time whether it works does not.
PROBE_TIMEOUT_S = 120.0

_lock = threading.Lock()
#: By process: the threads of a pool do not survive a fork.
_pools: dict[int, WorkerPool] = {}


def render(
    lane: str,
    scene: Scene,
    options: RenderOptions,
    *,
    progress: Progress | None = None,
) -> tuple[Rendering, float]:
    """Render in a worker; return the rendering and the peak memory in MiB.

    `options.timeout_s` bounds the whole call. `progress` is called in another thread. Raises what
    the lane raises, and RendererError where its process dies or takes too long.
    """
    limit_s = options.timeout_s
    task = Task(tasks.render, lane, timeout_s=limit_s, label=lane, on_progress=progress)
    made: tuple[Rendering, float] = call(task, lane, scene, options)
    return made


def render_to_file(
    scene: Scene,
    options: RenderOptions,
    path: Path,
    metadata: Mapping[str, str],
    rule: DisplayRule,
    *,
    progress: Progress | None = None,
) -> tuple[Rendering, float]:
    """Render by native in bands into an image file, all or nothing; no image is returned.

    Otherwise as `render`.
    """
    from crosstrace.harness.images import write_atomically

    limit_s = options.timeout_s
    task = Task(tasks.render_to_file, "native", timeout_s=limit_s, label="native",
                on_progress=progress)  # fmt: skip
    made: list[tuple[Rendering, float]] = []

    def fill(temporary: Path) -> None:
        made.append(call(task, scene, options, str(temporary), dict(metadata), rule))

    write_atomically(path, fill)
    return made[0]


def probe(lane: str) -> Probe:
    """Ask a lane whether it works here; one that crashes while it is asked does not."""
    label = f"{lane}: looking for it"
    found: Probe = call(Task(tasks.probe, lane, timeout_s=PROBE_TIMEOUT_S, label=label), lane)
    return found


def translate(lane: str, scene: Scene, options: RenderOptions | None = None) -> Translation:
    """Have a lane write a scene in its own language."""
    task = Task(tasks.translate, lane, timeout_s=PROBE_TIMEOUT_S, label=lane)
    made: Translation = call(task, lane, scene, options or RenderOptions())
    return made


def certify(scene: Scene, readings: Mapping[str, str], timeout_s: float | None) -> Layers:
    """Enclose every pixel: `lo`, `hi` (v_res, h_res, 3) and `undecidable` (v_res, h_res)."""
    task = Task(tasks.certify, "native", timeout_s=timeout_s, label="certifying")
    known: Layers = call(task, scene, dict(readings))
    return known


def explain(
    scene: Scene, row: int, column: int, readings: Mapping[str, str], timeout_s: float | None
) -> tuple[PixelTree, Enclosures | None]:
    """Record a pixel's ray tree and enclose its value."""
    task = Task(tasks.explain, "native", timeout_s=timeout_s, label="native: explaining")
    known: tuple[PixelTree, Enclosures | None] = call(task, scene, row, column, dict(readings))
    return known


def classes_at(
    scene: Scene,
    row: int,
    column: int,
    known: Enclosures,
    values: Mapping[str, Pixel],
    readings: Mapping[str, str],
    timeout_s: float | None,
) -> dict[str, str]:
    """Class each lane's value of the one pixel that `known` encloses."""
    task = Task(tasks.classes_at, "native", timeout_s=timeout_s, label="native: classing")
    found: dict[str, str] = call(task, scene, row, column, known, dict(values), dict(readings))
    return found


def pixels(
    lanes: Iterable[str], scene: Scene, options: RenderOptions, row: int, column: int
) -> Iterator[tuple[str, Pixel | BaseException]]:
    """Have lanes render side by side; yield each one's pixel, or why it has none, as they come."""
    lane_of = {}
    for lane in lanes:
        task = Task(tasks.pixel, lane, timeout_s=options.timeout_s, label=lane)
        lane_of[_pool().submit(task, lane, scene, options, row, column)] = lane
    try:
        for future in as_completed(lane_of):
            error = future.exception()
            yield lane_of[future], error or future.result()
    except (KeyboardInterrupt, SystemExit):
        _end()
        raise


def call(task: Task, *args: Any) -> Any:
    """Run a task of `tasks.py`, or one like them, in the worker of its affinity and wait for it."""
    try:
        return _pool().submit(task, *args).result()
    except (KeyboardInterrupt, SystemExit):
        _end()
        raise


def _pool() -> WorkerPool:
    with _lock:
        if os.getpid() not in _pools:
            _pools[os.getpid()] = WorkerPool(available_cores())
        return _pools[os.getpid()]


def _end() -> None:
    with _lock:
        pool = _pools.pop(os.getpid(), None)
    if pool is not None:
        pool.kill()
