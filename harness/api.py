"""What Python callers get as `crosstrace.…`: load, render, compare, translate, run.

Renderers run in worker processes that stay warm between calls and end with the calling process.
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crosstrace.harness import images, lanes, tasks
from crosstrace.harness.jobs import Task, WorkerPool
from crosstrace.harness.metrics import Metrics, checked_pair, difference, measure
from crosstrace.harness.run import TIMEOUT_S, run_sources
from crosstrace.harness.session import PROBE_TIMEOUT_S
from crosstrace.harness.sources import Source, find, find_one
from crosstrace.harness.ssim import similarity
from crosstrace.translators.errors import UsageError
from crosstrace.translators.renderer import (
    Probe,
    Progress,
    Rendering,
    RenderOptions,
    Translation,
)
from crosstrace.translators.scene import Scene

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Comparison:
    """Two images compared: numbers on linear float, SSIM on the display colour.

    `difference` is a − b, `ssim_map` the full map, both (v_res, h_res, 3); `ssim` and `ssim_map` are
    None below 11 pixels a side.
    """

    metrics: Metrics
    ssim: float | None
    ssim_map: Array | None
    difference: Array


def load(path: str | os.PathLike[str], delivery: int | None = None) -> Scene:
    """Read a scene file, or a packaged scene by its name; raises SceneError or UsageError."""
    return find_one(os.fspath(path), delivery=delivery).scene


def render(scene: Scene | str | os.PathLike[str], lane: str = "native", **options: Any) -> Array:
    """Render to linear RGB, (v_res, h_res, 3) float64; the options are those of `render_full`."""
    return render_full(scene, lane, **options).image


def render_full(
    scene: Scene | str | os.PathLike[str],
    lane: str = "native",
    *,
    readings: Mapping[str, str] | None = None,
    precision: str = "f64",
    threads: int = 0,
    layers: bool = False,
    effects: Iterable[str] | None = None,
    timeout_s: float | None = None,
    progress: Progress | None = None,
) -> Rendering:
    """Render in a worker process; return the image with times, settings and side outputs.

    Raises RendererMissingError, UnsupportedSceneError, or RendererError where the renderer fails,
    crashes or takes longer than `timeout_s`; UsageError for a wrong reading or lane.
    """
    options = RenderOptions(
        threads=threads,
        readings=dict(readings or {}),
        precision=precision,
        effects=None if effects is None else frozenset(effects),
        timeout_s=timeout_s,
        layers=layers,
    )
    return rendered(scene, lane, options, progress)[0]


def rendered(
    scene: Scene | str | os.PathLike[str],
    lane: str,
    options: RenderOptions,
    progress: Progress | None = None,
) -> tuple[Rendering, float]:
    """Render as `render_full` does, and return the worker's peak memory in MiB too."""
    task = _task(tasks.render, lane, timeout_s=options.timeout_s, progress=progress)
    made: tuple[Rendering, float] = _call(task, lane, _scene(scene), options)
    return made


def translate(
    scene: Scene | str | os.PathLike[str], lane: str, options: RenderOptions | None = None
) -> Translation:
    """Write a scene in a renderer's own language; raises as `render_full` does."""
    task = _task(tasks.translate, lane, timeout_s=TIMEOUT_S)
    made: Translation = _call(task, lane, _scene(scene), options or RenderOptions())
    return made


def probe(lane: str) -> Probe:
    """Say whether a renderer works here; raises RendererError where looking for it failed."""
    found: Probe = _call(_task(tasks.probe, lane, timeout_s=PROBE_TIMEOUT_S), lane)
    return found


def compare(a: Any, b: Any, scene: Scene | None = None) -> Comparison:
    """Compare two images, arrays (v_res, h_res, 3) or image files, on linear float.

    Raises UsageError where their shapes differ, or differ from the scene's.
    """
    first, second = checked_pair(_image(a), _image(b))
    if scene is not None and scene.shape != first.shape:
        found = f"{first.shape[0]}x{first.shape[1]}"
        raise UsageError(f"expected images of {scene.v_res}x{scene.h_res} pixels, found {found}")
    alike = similarity(first, second)
    return Comparison(measure(first, second), alike.mean, alike.map, difference(first, second))


def run(
    scenes: Iterable[Scene | str | os.PathLike[str]] = (),
    output: str | os.PathLike[str] = "report",
    *,
    renderers: str | Iterable[str] | None = None,
    size: tuple[int, int] | None = None,
    jobs: int | None = None,
    timeout_s: float | None = TIMEOUT_S,
) -> dict[str, Any]:
    """Render scenes through every lane, write the report to `output`, return its record.

    No scenes: the packaged course scenes. `size` is (rows, columns). A renderer that is missing or
    fails stands in the record and raises nothing.
    """
    sources: list[Source] = []
    for scene in scenes:
        if isinstance(scene, Scene):
            sources.append(Source(scene.name, scene if size is None else scene.resized(*size)))
        else:
            sources += find([os.fspath(scene)], size=size)
    chosen = lanes.chosen(renderers)
    finished = run_sources(
        sources or find(size=size), chosen, Path(output), jobs=jobs, timeout_s=timeout_s
    )
    return finished.report


def _scene(scene: Scene | str | os.PathLike[str]) -> Scene:
    return scene if isinstance(scene, Scene) else load(scene)


def _image(image: Any) -> Any:
    return images.read(image) if isinstance(image, str | os.PathLike) else image


def _task(
    function: Any, lane: str, *, timeout_s: float | None = None, progress: Progress | None = None
) -> Task:
    (lane,) = lanes.chosen([lane])
    return Task(function, lane, timeout_s=timeout_s, label=lane, on_progress=progress)


_pools: dict[int, WorkerPool] = {}


def _call(task: Task, *args: Any) -> Any:
    """Run a task in the pool of this process; an interrupt ends the pool and its renderers."""
    # Keyed by process: a fork must not use the pool of its parent.
    pool = _pools.get(os.getpid())
    if pool is None:
        pool = _pools[os.getpid()] = WorkerPool(1)
    try:
        return pool.submit(task, *args).result()
    except KeyboardInterrupt:
        _pools.pop(os.getpid()).kill()
        raise
