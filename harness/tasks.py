"""What runs inside a worker process: the calls of one lane.

Every function here is sent by name, so it takes and returns plain data. `progress` is given by the
worker where the caller wants to be told.
"""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from crosstrace.harness.lanes import loaded
from crosstrace.harness.memory import PeakMemory, available_bytes
from crosstrace.translators.errors import RendererError, UnsupportedSceneError
from crosstrace.translators.renderer import (
    Probe,
    Progress,
    Renderer,
    Rendering,
    RenderOptions,
    Seconds,
    Translation,
)
from crosstrace.translators.sampling import CENTRE, means
from crosstrace.translators.scene import Scene

if TYPE_CHECKING:
    from crosstrace.harness.display import DisplayRule
    from crosstrace.translators.native.explain import PixelTree
    from crosstrace.translators.native.stability import Stability
    from crosstrace.translators.native.truth import Enclosures


#: Bytes of a pixel on its way to the caller: pickled, framed, and unpacked again on the other side.
_HANDED_OVER = 4 * 24


def probe(lane: str) -> Probe:
    """Ask a lane whether it works here."""
    return loaded(lane).probe()


def translate(lane: str, scene: Scene, options: RenderOptions) -> Translation:
    """Have a lane write a scene in its own language."""
    return loaded(lane).translate(scene, options)


def certify(scene: Scene, readings: Mapping[str, str]) -> dict[str, NDArray[Any]]:
    """Enclose the true value of every pixel; see `crosstrace.translators.native.truth`."""
    from crosstrace.translators.native.truth import certify as enclose

    known = enclose(scene, readings)
    return {"lo": known.lo, "hi": known.hi, "undecidable": known.undecidable}


def explain(
    scene: Scene, row: int, column: int, readings: Mapping[str, str]
) -> tuple[PixelTree, Enclosures | None]:
    """Record a pixel's ray tree and enclose it; None where a reading leaves truth no meaning."""
    from crosstrace.translators.native.explain import explain as record_tree
    from crosstrace.translators.native.truth import certify as enclose

    tree = record_tree(scene, row, column, readings)
    if readings.get("offset") == "bound":
        return tree, None
    return tree, enclose(scene, readings, pixels=np.array([row * scene.h_res + column]))


def classes_at(
    scene: Scene,
    row: int,
    column: int,
    known: Enclosures,
    values: Mapping[str, tuple[tuple[float, float, float], float]],
    readings: Mapping[str, str],
) -> dict[str, str]:
    """Class each lane's value, with its half step, of the one pixel that `known` encloses."""
    from crosstrace.harness.classes import NAMES, classify

    pixels = np.array([row * scene.h_res + column])
    return {
        lane: NAMES[
            int(
                classify(
                    scene, known, np.array([value]), loaded(lane).ledger(scene),
                    half_step=half_step, readings=readings, pixels=pixels,
                ).classes[0]
            )
        ]
        for lane, (value, half_step) in values.items()
    }  # fmt: skip


def pixel(
    lane: str, scene: Scene, options: RenderOptions, row: int, column: int
) -> tuple[tuple[float, float, float], float]:
    """Render, and return one pixel's colour and the half width of the output's quantisation."""
    made, _ = render(lane, scene, options)
    red, green, blue = made.image[row, column].tolist()
    return (red, green, blue), made.half_step


def stability(scene: Scene, threads: int) -> Stability:
    """Measure a scene in every rung; see `crosstrace.translators.native.stability`."""
    from crosstrace.translators.native.stability import measure

    return measure(scene, threads=threads)


def render(
    lane: str, scene: Scene, options: RenderOptions, progress: Progress | None = None
) -> tuple[Rendering, float]:
    """Render by a lane; return the rendering, checked, and the peak memory in MiB.

    The time to load the lane's own code counts as start-up of the first image of a process. Raises
    as `drawn`.
    """
    started = time.perf_counter()
    renderer = loaded(lane)
    loading_s = time.perf_counter() - started
    made, peak_mib = drawn(renderer, scene, options, progress)
    made.seconds.startup += loading_s
    return made, peak_mib


def render_to_file(
    scene: Scene,
    options: RenderOptions,
    path: str,
    metadata: Mapping[str, str],
    rule: DisplayRule,
    progress: Progress | None = None,
) -> tuple[Rendering, float]:
    """Render by native in bands, straight into a file; return the rendering without its image.

    The file is written as the bands come: give a temporary name. `settings` hold the rays of all
    bands. Raises as `drawn`.
    """
    from crosstrace.harness.display import GUARD_F32, GUARD_F64
    from crosstrace.harness.row_files import writing
    from crosstrace.translators.native.adapter import Native

    guard = GUARD_F32 if options.precision == "f32" else GUARD_F64
    whole = Rendering(np.empty((0, scene.h_res, 3)), Seconds())
    with (
        PeakMemory() as memory,
        writing(Path(path), scene.shape, metadata, rule, guard) as write,
    ):
        for band in Native().bands(scene, options, progress):
            write(band.image)
            whole.seconds.translate += band.seconds.translate
            whole.seconds.render += band.seconds.render
            rays = whole.settings.get("rays", {})
            counted = {
                kind: n + rays.get(kind, 0) if kind != "threads" else n
                for kind, n in band.settings["rays"].items()
            }
            whole.settings = band.settings | {"rays": counted}
    return whole, memory.mib


def check_memory(renderer: Renderer, scene: Scene, options: RenderOptions) -> None:
    """Raise UnsupportedSceneError where an image would not fit into the memory that is free."""
    limits = renderer.capabilities
    each = limits.bytes_per_pixel + _HANDED_OVER
    if options.layers:
        each += limits.layer_bytes_per_pixel
    needed, free = scene.v_res * scene.h_res * each, available_bytes()
    if free is not None and needed > free:
        raise UnsupportedSceneError(
            f"{renderer.name}: an image of {scene.v_res}x{scene.h_res} pixels needs about"
            f" {needed / 2**30:.1f} GiB of memory, found {free / 2**30:.1f} GiB free"
        )


def drawn(
    renderer: Renderer, scene: Scene, options: RenderOptions, progress: Progress | None = None
) -> tuple[Rendering, float]:
    """Render by a renderer and check what comes back; return it and the peak memory in MiB.

    Raises UnsupportedSceneError beyond a declared limit or the memory that is free, RendererError
    where the answer is no image.
    """
    limits = renderer.capabilities
    if options.sampling.kind == "regular" and not limits.samples:
        return _averaged(renderer, scene, options, progress)
    for what, value, limit in (
        ("objects", len(scene), limits.max_objects),
        ("bounces", scene.max_depth, limits.max_depth),
        ("pixels", scene.v_res * scene.h_res, limits.max_pixels),
    ):
        if limit is not None and value > limit:
            raise UnsupportedSceneError(
                f"{renderer.name} takes at most {limit} {what}, not {value}"
            )
    check_memory(renderer, scene, options)
    with PeakMemory() as memory:
        made = renderer.render(scene, options, progress)
    if not isinstance(made.image, np.ndarray) or made.image.shape != scene.shape:
        found = getattr(made.image, "shape", type(made.image).__name__)
        raise RendererError(f"{renderer.name}: expected an image {scene.shape}, found {found}")
    made.image = np.ascontiguousarray(made.image, np.float64)
    return made, memory.mib


def _averaged(
    renderer: Renderer, scene: Scene, options: RenderOptions, progress: Progress | None
) -> tuple[Rendering, float]:
    """Render a finer frame, whose pixels' centres are the regular samples, and average them."""
    side = options.sampling.side
    fine = scene.resized(scene.v_res * side, scene.h_res * side)
    made, peak_mib = drawn(renderer, fine, replace(options, sampling=CENTRE), progress)
    started = time.perf_counter()
    made.image = means(made.image, side)
    made.seconds.render += time.perf_counter() - started
    made.settings["sampling"] = str(options.sampling)
    made.layers = {}
    return made, peak_mib
