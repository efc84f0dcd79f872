"""Many samples a pixel, averaged: the frame at `side` times its resolution, band by band.

The centres of the finer frame's pixels are the regular samples of the coarser one; its `jitter`
moves each of them within its square. Adaptive sampling begins with four samples a pixel and traces
all of a pixel's where two adjacent samples, of it or of its neighbours, differ in their ray trees
or by more than `CONTRAST`: where four samples see one and the same thing, more would, too, unless
something is smaller than their distance.
"""

from __future__ import annotations

from collections import Counter
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crosstrace.native import _core
from crosstrace.translators.renderer import Progress
from crosstrace.translators.sampling import Sampling, means
from crosstrace.translators.scene import Scene

Array = NDArray[np.float64]

#: Samples a side with which adaptive sampling begins.
FIRST_SIDE = 2

#: Adjacent samples that differ by more, in any channel, are looked at more closely: five levels of
#: an 8-bit image.
CONTRAST = 0.02

#: Samples that are held at once: 24 bytes each.
_AT_ONCE = 1 << 21

#: Settings of the native tracer, as `_core.render` takes them.
Settings = list[tuple[str, str]]


def sampled(
    scene: Scene, settings: Settings, sampling: Sampling, progress: Progress | None = None
) -> tuple[Array, dict[str, int]]:
    """Return the mean of each pixel's samples, (v_res, h_res, 3), and the counts of all rays.

    Raises as `_core.render`.
    """
    told = progress or (lambda fraction: None)
    if sampling.kind == "adaptive":
        return _adaptive(scene, settings, sampling.side, told)
    if sampling.kind == "jittered":
        settings = [*settings, ("jitter", str(sampling.seed))]
    return _full(scene, settings, sampling.side, told)


def refined(trees: NDArray[np.uint64], colors: Array) -> NDArray[np.bool_]:
    """Say of each pixel whether it is to be sampled closely, (v_res, h_res).

    `trees` (2·v_res, 2·h_res) and `colors` (…, 3) are of its first samples.
    """
    differs = np.zeros(trees.shape, np.bool_)
    for axis in (0, 1):
        later: tuple[Any, ...] = (slice(None),) * axis + (slice(1, None),)
        earlier: tuple[Any, ...] = (slice(None),) * axis + (slice(None, -1),)
        apart = np.abs(colors[later] - colors[earlier]).max(axis=-1) > CONTRAST
        apart |= trees[later] != trees[earlier]
        differs[later] |= apart
        differs[earlier] |= apart
    rows, columns = trees.shape
    blocks = differs.reshape(rows // FIRST_SIDE, FIRST_SIDE, columns // FIRST_SIDE, FIRST_SIDE)
    return np.asarray(blocks.any(axis=(1, 3)))


def _finer(scene: Scene, side: int) -> Scene:
    return scene.resized(scene.v_res * side, scene.h_res * side)


def _full(
    scene: Scene, settings: Settings, side: int, progress: Progress
) -> tuple[Array, dict[str, int]]:
    fine, image = _finer(scene, side).native_view(), np.empty(scene.shape)
    rows = max(1, _AT_ONCE // (scene.h_res * side * side))
    rays: Counter[str] = Counter()
    tree = _core.tree(fine, None)
    for top in range(0, scene.v_res, rows):
        bottom = min(top + rows, scene.v_res)
        band = np.empty(((bottom - top) * side, scene.h_res * side, 3))
        span = [("row_begin", str(top * side)), ("row_end", str(bottom * side))]
        rays.update(_core.render(fine, [*settings, *span], {"image": band}, None, tree))
        image[top:bottom] = means(band, side)
        progress(bottom / scene.v_res)
    return image, _counts(rays)


def _adaptive(
    scene: Scene, settings: Settings, side: int, progress: Progress
) -> tuple[Array, dict[str, int]]:
    shape = scene.v_res * FIRST_SIDE, scene.h_res * FIRST_SIDE
    colors, trees = np.empty((*shape, 3)), np.empty(shape, np.uint64)
    rays: Counter[str] = Counter()
    first = _finer(scene, FIRST_SIDE).native_view()
    tree = _core.tree(first, None)
    rays.update(_core.render(first, settings, {"image": colors, "tree": trees}, None, tree))
    image = means(colors, FIRST_SIDE)
    cells = np.flatnonzero(refined(trees, colors)).astype(np.int64)
    fine, pixels = _finer(scene, side).native_view(), image.reshape(-1, 3)
    at_once = max(1, _AT_ONCE // side**2)
    for start in range(0, len(cells), at_once):
        some = np.ascontiguousarray(cells[start : start + at_once])
        samples = np.empty((len(some), side * side, 3))
        counts = _core.render(fine, settings, {"image": samples}, None, tree, some, side)
        rays.update(counts)
        pixels[some] = samples.mean(axis=1)
        progress((start + len(some)) / len(cells))
    return image, {**_counts(rays), "refined": len(cells)}


def _counts(rays: Counter[str]) -> dict[str, int]:
    """Return the sums; of the threads, which are no rays, nothing."""
    return {name: count for name, count in rays.items() if name != "threads"}
