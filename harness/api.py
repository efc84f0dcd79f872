"""The Python interface: what `import crosstrace` offers beside scenes and errors.

Renderers run in worker processes started as a module of ours, so this works from a plain script
without a `__main__` guard, and a renderer that crashes raises RendererError here.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crosstrace.harness import one_image
from crosstrace.harness.lanes import chosen
from crosstrace.harness.metrics import Metrics, measure
from crosstrace.harness.sources import Source, find
from crosstrace.harness.ssim import Similarity, similarity
from crosstrace.translators.course import load
from crosstrace.translators.effects import effects
from crosstrace.translators.errors import UsageError
from crosstrace.translators.registry import LANES
from crosstrace.translators.renderer import Rendering, RenderOptions
from crosstrace.translators.scene import Scene

__all__ = [
    "LANES", "Comparison", "compare", "effects", "load", "render", "render_full", "run",
]  # fmt: skip


@dataclass(frozen=True)
class Comparison:
    """Two images of one size: `metrics` on linear float, `ssim` on the display colour."""

    metrics: Metrics
    ssim: Similarity


def render(scene: Scene, lane: str = "native", **options: Any) -> NDArray[np.float64]:
    """Render a scene with a lane; return linear RGB (v_res, h_res, 3), row 0 at the top.

    `options` are fields of `RenderOptions`, such as threads=2 or readings={"tir": "ignore"}.
    Raises RendererMissingError, UnsupportedSceneError or RendererError.
    """
    return render_full(scene, lane, **options).image


def render_full(scene: Scene, lane: str = "native", **options: Any) -> Rendering:
    """Render as `render`, and return the times, settings and side outputs too."""
    return one_image.render(lane, scene, RenderOptions(**options))


def compare(a: Any, b: Any, scene: Scene | None = None) -> Comparison:
    """Compare two images (v_res, h_res, 3); with a scene, both must have its size."""
    if scene is not None and np.shape(a) != scene.shape:
        raise UsageError(f"expected images of shape {scene.shape}, found {np.shape(a)}")
    return Comparison(measure(a, b), similarity(a, b))


def run(
    scenes: Iterable[Scene | str | Path] = (),
    output: str | Path = "report",
    *,
    renderers: Iterable[str] | None = None,
    **settings: Any,
) -> Mapping[str, Any]:
    """Do what `crosstrace run` does and return the report; scenes may be Scenes, files or names."""
    from crosstrace.harness.run import run_sources

    sources: list[Source] = []
    for item in scenes:
        sources += [Source(item.name, item)] if isinstance(item, Scene) else find([str(item)])
    lanes = chosen(renderers)
    return run_sources(sources or find(), lanes, Path(output), **settings).report
