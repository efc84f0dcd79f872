"""Conditioning: what rounding may do to a pixel, for values that differ from truth.

Two models of a renderer's arithmetic, both under any reading (section 5 of the design):

- the *sampled envelope*: the pixel rendered many times in double with random errors of the size of
  the arithmetic's own (`native/src/perturb.inc.h`). It has the power: a box for every ray tree that
  occurs is narrow even where their hull is wide, as behind many layers of glass.
- the *inflated enclosure*: intervals widened by that error everywhere (`certify` with kappa). It
  has the proof: outside it a value is wrong. Behind glass it says little.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import IntEnum
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crosstrace.native import _core
from crosstrace.translators import readings as readings_of_the_specification
from crosstrace.translators.effects import effects
from crosstrace.translators.errors import RendererError
from crosstrace.translators.ledger import Arithmetic
from crosstrace.translators.native.truth import MAX_ALTERNATIVES, certify
from crosstrace.translators.renderer import Progress
from crosstrace.translators.scene import Scene

Floats = NDArray[np.float64]

#: Units of rounding that a colour of magnitude 1 or less may carry without an error of directions
#: or hits: sums, products and the highlight's power.
COLOR_UNITS = 4.0

#: Samples of each pass, and at most how many of the pixels left are tried again in it.
PASSES = ((16, 1 << 62), (256, 4096), (4096, 256))


class Conditioned(IntEnum):
    """What a value is, given the arithmetic that made it."""

    EXPLAINED = 0
    SUSPECT = 1
    WRONG = 2


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
        if n == 0 or count == 0:
            return np.zeros(n, np.bool_)
        pixel = np.repeat(np.arange(n), count)
        trees = self.trees.ravel()
        order = np.lexsort((trees, pixel))
        pixel, trees = pixel[order], trees[order]
        first = np.ones(len(order), np.bool_)
        first[1:] = (np.diff(pixel) != 0) | (trees[1:] != trees[:-1])
        starts = np.flatnonzero(first)
        sorted_colors = self.colors.reshape(-1, 3)[order]
        low = np.minimum.reduceat(sorted_colors, starts)
        high = np.maximum.reduceat(sorted_colors, starts)
        m = np.diff(starts, append=len(order))[:, None].astype(np.float64)
        owner = pixel[starts]
        reach = (high - low) / 2 * (m + 1) / np.maximum(m - 1, 1)
        widest = np.zeros((n, 3))
        np.maximum.at(widest, owner, reach)
        reach = np.where(m > 1, reach, widest[owner])
        room = widen * reach + np.broadcast_to(slack, (n,))[owner][:, None]
        fits = (np.abs(values[owner] - (low + high) / 2) <= room).all(axis=1)
        answer = np.zeros(n, np.bool_)
        answer[owner[fits]] = True
        return answer


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


def judge(
    scene: Scene,
    values: Floats,
    *,
    pixels: NDArray[np.integer[Any]],
    arithmetic: Arithmetic,
    readings: Mapping[str, str] | None = None,
    slack: float | Floats = 0.0,
    threads: int = 0,
) -> NDArray[np.uint8]:
    """Say of each foreign value (n, 3) of `pixels` (n,) what it is: (n,) of `Conditioned`.

    `slack`, a number or (n,), is what the output's quantisation may add. EXPLAINED: inside the
    sampled envelope. WRONG: outside the inflated enclosure, whatever rounding did. SUSPECT:
    between. Meant for the pixels over tolerance; pixels left over are tried again with more
    samples, but only so many, so that a grossly faulty image costs no more than a good one. Raises
    as `envelope`, and UsageError for offset=bound.
    """
    pixels = np.ascontiguousarray(pixels, np.int64).ravel()
    values = np.asarray(values, np.float64).reshape(-1, 3)
    largest = np.maximum(1.0, np.abs(values).max(axis=1, initial=0.0))
    room = np.broadcast_to(slack, pixels.shape) + COLOR_UNITS * arithmetic.color_unit * largest
    answer = np.full(len(pixels), Conditioned.SUSPECT, np.uint8)
    left = np.arange(len(pixels))
    for number, (samples, most) in enumerate(PASSES):
        tried = _spread(left, most)
        # A pass's memory is bounded too: 32 bytes a sample.
        for part in np.array_split(tried, 1 + len(tried) * samples // (1 << 20)):
            seen = envelope(scene, readings, pixels=pixels[part], error=arithmetic.error,
                            samples=samples, seed=number, threads=threads)  # fmt: skip
            inside = seen.contains(values[part], slack=room[part])
            answer[part[inside]] = Conditioned.EXPLAINED
        left = np.flatnonzero(answer != Conditioned.EXPLAINED)
    wrong = impossible(
        scene, values[left], pixels=pixels[left], error=arithmetic.error, readings=readings,
        room=room[left], threads=threads,
    )  # fmt: skip
    answer[left[wrong]] = Conditioned.WRONG
    return answer


def _spread(items: NDArray[np.intp], most: int) -> NDArray[np.intp]:
    """Return at most so many of the items, evenly from first to last."""
    if len(items) <= most:
        return items
    return items[np.linspace(0, len(items) - 1, most).astype(np.intp)]


def impossible(
    scene: Scene,
    values: Floats,
    *,
    pixels: NDArray[np.integer[Any]],
    error: float,
    room: Floats,
    readings: Mapping[str, str] | None = None,
    threads: int = 0,
) -> NDArray[np.bool_]:
    """Say where no value that arithmetic with this relative error may return is near: rigorous.

    Near is within `room` (n,) of the given values (n, 3).
    """
    known = certify(scene, readings, pixels=pixels, kappa=error, threads=threads)
    near = known.contains(values, room)
    # Where all outcomes are listed, a value between them is as wrong as one outside their hull.
    # A full list may be one cut short.
    listed = known.n_alternatives
    complete = (listed > 0) & (listed < MAX_ALTERNATIVES)
    open_ones = np.flatnonzero(known.undecidable)
    room_there = room[open_ones][:, None, None]
    value = values[open_ones][:, None, :]
    fits = (known.alternatives[:, :, 0] - room_there <= value) & (
        value <= known.alternatives[:, :, 1] + room_there
    )
    counted = np.arange(MAX_ALTERNATIVES) < listed[:, None]
    in_one = (fits.all(axis=-1) & counted).any(axis=-1)
    near[open_ones] &= in_one | ~complete
    return np.asarray(~near)
