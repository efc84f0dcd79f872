"""The sampled envelope: what random errors of the size of rounding do to a pixel.

Every pixel is rendered many times in double, its directions and hits moved by up to the relative
error of the arithmetic under test (`native/src/perturb.inc.h`). Samples are grouped by ray tree:
where two differ in no decision their colours differ smoothly and little, so that a box for each
tree is narrow even where the hull of all is as wide as the picture's range, as behind glass.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crosstrace.native import _core
from crosstrace.translators import readings as readings_of_the_specification
from crosstrace.translators.channels import every
from crosstrace.translators.effects import effects
from crosstrace.translators.errors import RendererError
from crosstrace.translators.renderer import Progress
from crosstrace.translators.scene import Scene

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Envelope:
    """Perturbed renders of n pixels, K each: `colors` (n, K, 3), `trees` (n, K) of ray trees."""

    colors: Floats
    trees: NDArray[np.uint64]

    def contains(
        self, values: Floats, widen: float = 2.0, slack: float | Floats = 0.0
    ) -> NDArray[np.bool_]:
        """Say of each value (n, 3) whether rounding explains it; slack is a number or (n,).

        Samples of one ray tree share all decisions; a value is explained where it lies in the box
        of one tree's samples, widened `widen` times about its middle and by `slack`. The range of
        m samples falls short of that of their distribution by (m - 1)/(m + 1) if that is uniform,
        and the boxes make up for it; a tree that occurs once takes the size of the pixel's largest
        box.
        """
        n, count = self.trees.shape
        answer = np.zeros(n, np.bool_)
        if n == 0 or count == 0:
            return answer
        owner, starts, order = self._groups
        colors = self.colors.reshape(-1, 3)[order]
        low, high = np.minimum.reduceat(colors, starts), np.maximum.reduceat(colors, starts)
        m = np.diff(starts, append=len(order))[:, None].astype(np.float64)
        reach = (high - low) / 2 * (m + 1) / np.maximum(m - 1, 1)
        widest = np.zeros((n, 3))
        np.maximum.at(widest, owner, reach)
        reach = np.where(m > 1, reach, widest[owner])
        room = widen * reach + np.broadcast_to(slack, (n,))[owner][:, None]
        fits = every(np.abs(values[owner] - (low + high) / 2) <= room)
        answer[owner[fits]] = True
        return answer

    def in_hull(self, values: Floats, slack: float | Floats = 0.0) -> NDArray[np.bool_]:
        """Say of each value whether it lies in the box of all samples, wider by a quarter."""
        low, high = self.colors.min(axis=1), self.colors.max(axis=1)
        room = 1.25 * (high - low) / 2 + np.broadcast_to(slack, (len(values),))[:, None]
        return every(np.abs(values - (low + high) / 2) <= room)

    @property
    def unseen(self) -> Floats:
        """The estimated chance (n,) that one more sample has a ray tree not met so far.

        The share of the samples whose tree occurs once (Good 1953, after Turing).
        """
        return self.unseen_among(self.trees.shape[1] - 1)

    def unseen_among(self, m: int) -> Floats:
        """The estimated chance (n,) that one more sample has a tree not met by m others, m < K.

        A tree that occurs c times among the K is held by one of them and missed by m of the other
        K - 1 with the chance c/K * C(K - c, m) / C(K - 1, m).
        """
        n, count = self.trees.shape
        owner, starts, order = self._groups
        c = np.arange(1, count)
        missed = np.cumprod(np.maximum(count - c - m, 0) / np.maximum(count - c, 1))
        chance = np.concatenate(([0.0, 1.0], missed)) * np.arange(count + 1) / max(count, 1)
        sizes = np.diff(starts, append=len(order))
        return np.asarray(np.bincount(owner, chance[sizes], minlength=n), np.float64)

    @cached_property
    def _groups(self) -> tuple[NDArray[np.intp], NDArray[np.intp], NDArray[np.intp]]:
        """Sort all samples by pixel and tree: the pixel and the start of each group, the order."""
        n, count = self.trees.shape
        pixel = np.repeat(np.arange(n), count)
        trees = self.trees.ravel()
        order = np.lexsort((trees, pixel))
        pixel, trees = pixel[order], trees[order]
        first = np.ones(len(order), np.bool_)
        first[1:] = (pixel[1:] != pixel[:-1]) | (trees[1:] != trees[:-1])
        starts = np.flatnonzero(first)
        return pixel[starts], starts, order


def envelope(
    scene: Scene,
    readings: Mapping[str, str] | None = None,
    *,
    pixels: NDArray[np.integer[Any]],
    error: float,
    samples: int = 16,
    seed: int = 0,
    threads: int = 0,
    progress: Progress | None = None,
) -> Envelope:
    """Render `pixels` (row·h_res + column) `samples` times with relative errors up to `error`.

    A sample depends on seed, pixel and its own number alone. Raises UsageError for a reading that
    does not exist, RendererError where the ray budget is used up.
    """
    readings = dict(readings or {})
    readings_of_the_specification.check(readings)
    wanted = np.ascontiguousarray(pixels, np.int64).ravel()
    made = Envelope(
        np.empty((len(wanted), samples, 3)), np.empty((len(wanted), samples), np.uint64)
    )
    settings = [*readings.items(), ("threads", str(threads)),
                ("effects", str(effects(scene, readings).overall))]  # fmt: skip
    try:
        _core.perturb(scene.native_view(), settings, wanted, samples, error, seed,
                      {"colors": made.colors, "trees": made.trees}, progress)  # fmt: skip
    except RuntimeError as problem:
        raise RendererError(f"conditioning: {problem}") from None
    return made
