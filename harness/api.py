"""What `import crosstrace` offers: scenes in, arrays and records out."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crosstrace.harness import alone, sources
from crosstrace.translators.renderer import Probe, Rendering, RenderOptions, Translation
from crosstrace.translators.scene import Scene


def load(
    scene: str | os.PathLike[str],
    *,
    delivery: int | None = None,
    size: tuple[int, int] | None = None,
) -> Scene:
    """Read a scene file, or a packaged scene by its name.

    `delivery` (1, 2, 3) overrides what the text says, `size` (rows, columns) the resolution, with
    the same field of view. Raises SceneError with line and column, or UsageError.
    """
    return sources.find_one(os.fspath(scene), delivery=delivery, size=size).scene


def render(scene: Scene, lane: str = "native", **options: Any) -> NDArray[np.float64]:
    """Render a scene: linear RGB, (v_res, h_res, 3) float64, row 0 at the top, unclamped.

    The options are those of `render_full`, which returns more than the image.
    """
    return render_full(scene, lane, **options).image


def render_full(
    scene: Scene,
    lane: str = "native",
    *,
    threads: int = 0,
    readings: Mapping[str, str] | None = None,
    precision: str = "f64",
    effects: Iterable[str] | None = None,
    layers: bool = False,
    tolerance: float = 0.0,
    timeout_s: float | None = alone.TIMEOUT_S,
    progress: Callable[[float], None] | None = None,
) -> Rendering:
    """Render in a worker process and return the image with its times, settings and side outputs.

    `lane` is one of `LANES`, or ``module:factory`` for a renderer from outside this package.
    `threads` 0 uses all cores; `readings` name another interpretation of the specification,
    `effects` None means what the scene calls for; `layers` asks for the native side outputs;
    `tolerance` lets native leave out rays that darken no channel by more than that;
    `progress` is called in another thread with the fraction done. Raises UsageError for a wrong
    name, RendererMissingError, UnsupportedSceneError, or RendererError where the renderer fails,
    dies, or takes longer than `timeout_s`.
    """
    wanted = None if effects is None else frozenset(effects)
    options = RenderOptions(
        threads, dict(readings or {}), precision, wanted, timeout_s, layers, tolerance
    )
    return alone.render(lane, scene, options, progress=progress)[0]


def translate(scene: Scene, lane: str) -> Translation:
    """Write a scene in a renderer's own language: its files, and the line that renders them.

    Raises UsageError for a wrong name, UnsupportedSceneError where the scene cannot be expressed.
    """
    return alone.translate(lane, scene)


def probe(lane: str) -> Probe:
    """Say whether a renderer works here; raises RendererError where it dies of being asked."""
    return alone.probe(lane)
