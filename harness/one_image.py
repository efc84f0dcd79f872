"""One image at a time, in a worker process: for `crosstrace render` and the Python API.

A renderer that crashes or hangs cannot take the caller down.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from crosstrace.harness import tasks
from crosstrace.harness.jobs import Task, WorkerPool
from crosstrace.harness.lanes import chosen
from crosstrace.harness.schedule import Event
from crosstrace.translators.renderer import Rendering, RenderOptions, Translation
from crosstrace.translators.scene import Scene

#: What the worker may take beyond the renderer's own limit before it is killed.
_GRACE_S = 5.0


def render(
    lane: str,
    scene: Scene,
    options: RenderOptions,
    observe: Callable[[Event], None] | None = None,
) -> Rendering:
    """Render a scene with one lane; raises what the lane raises, RendererError where it dies."""
    (lane,) = chosen([lane])

    def tell(fraction: float) -> None:
        if observe is not None:
            observe(Event("progress", scene.name, lane, "render", 0, 1, fraction=fraction))

    limit = None if options.timeout_s is None else options.timeout_s + _GRACE_S
    task = Task(tasks.render, affinity=lane, timeout_s=limit, label=lane, on_progress=tell)
    rendering, _ = _run(task, lane, scene, options)
    made: Rendering = rendering
    return made


def translate(lane: str, scene: Scene, options: RenderOptions | None = None) -> Translation:
    """Write a scene in a lane's own language."""
    (lane,) = chosen([lane])
    task = Task(tasks.translate, affinity=lane, label=lane)
    translation: Translation = _run(task, lane, scene, options or RenderOptions())
    return translation


def certify(scene: Scene, readings: Mapping[str, str]) -> dict[str, Any]:
    """Return `lo` and `hi` (v_res, h_res, 3) and `undecidable` (v_res, h_res)."""
    from crosstrace.translators.native.truth import certify as enclose

    known = enclose(scene, readings)
    return {"lo": known.lo, "hi": known.hi, "undecidable": known.undecidable}


def _run(task: Task, *arguments: Any) -> Any:
    with WorkerPool(1) as pool:
        future = pool.submit(task, *arguments)
        try:
            return future.result()
        except KeyboardInterrupt:
            pool.kill()
            raise
