"""The pixels of one image that nothing has explained yet, and what explains them.

A value is explained by a *meaning* of the scene (the specification's, or a renderer's habits) where
that meaning encloses it, or where honest arithmetic of the renderer's kind may return it (the
sampled envelope). What is left is impossible, or merely unlikely.

Work is spent where it pays: few samples for all pixels, more for those left. What is proven to be
impossible needs no samples, and in a grossly faulty image that is nearly everything, so that there
proofs go first. What comes to nothing is given up early, so that no image costs more than minutes;
what was not reached stays unexplained, and is not called impossible.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crosstrace.translators.channels import every, largest
from crosstrace.translators.ledger import Arithmetic, Emulation
from crosstrace.translators.native.envelope import Envelope, Floats, envelope
from crosstrace.translators.native.truth import MAX_ALTERNATIVES, certify

Items = NDArray[np.intp]
Flags = NDArray[np.bool_]

#: Units of rounding that a colour of magnitude 1 or less may carry without an error of directions
#: or hits: sums, products and the highlight's power.
COLOR_UNITS = 4.0

#: Samples of the passes over what no pass has explained, and of the last one.
PASSES = (16, 64, 256)
LAST = 4096

#: Chance of a ray tree not met from which on more samples are no remedy.
HOPELESS = 1 / 16

#: Samples after which a pass gives up if it explains fewer than a quarter of its pixels.
PATIENCE = 1 << 18

#: Hopeless pixels that are looked at with `LAST` samples.
LOOKED_AT = 256

#: Parts in which these are looked at, and the standard deviations that end it before the last.
LOOKS, BEFORE_THE_LAST_LOOK = 4, 5.0

#: Pixels of a round of proofs; before sampling, the next one needs half of them proven impossible,
#: and the first one half of a few, as a proof costs the more the less it succeeds.
ROUND, FEW = 1024, 64

#: Pixels after which proofs are given up if fewer than one in fifty succeeds, and at most tried.
PROVEN_AT_LEAST, PROVEN = 2048, 1 << 15


class Unexplained:
    """Values (n, 3) of an image at `pixels` (n,), row·h_res + column, each with a tolerance.

    All methods speak of *items*, indices into `pixels`; `left` are those not taken out yet.
    """

    def __init__(
        self,
        pixels: NDArray[np.integer[Any]],
        values: Floats,
        slack: Floats,
        arithmetic: Arithmetic,
        threads: int = 0,
    ) -> None:
        """Begin with all of them; `slack` (n,) is what the output's quantisation may add."""
        self.left: Items = np.arange(len(pixels))
        self._pixels = np.ascontiguousarray(pixels, np.int64)
        self._values, self._slack = values, slack
        size = np.maximum(1.0, largest(np.abs(values)))
        self._room = slack + COLOR_UNITS * arithmetic.color_unit * size
        self._error, self._threads = arithmetic.error, threads

    def take_enclosed(self, meaning: Emulation) -> Items:
        """Take out and return what is certified under a meaning."""
        if not len(self.left):
            return self.left
        known = certify(
            meaning.scene, meaning.readings, pixels=self._pixels[self.left], threads=self._threads
        )
        enclosed = every(np.isfinite(known.lo))
        fits = known.fits_alternative(self._values[self.left], self._slack[self.left])
        return self._take(self.left[enclosed & fits])

    def drop_impossible(self, meanings: Sequence[Emulation]) -> None:
        """Take out for good what is proven to be impossible, as long as that is most of it."""
        few = spread(self.left, FEW)
        if 2 * len(self._take(self._impossible(meanings, few))) < len(few):
            return
        for part in _rounds(self.left):
            found = self._take(self._impossible(meanings, part))
            if 2 * len(found) < len(part):
                break

    def take_rounded(self, meaning: Emulation) -> Items:
        """Take out and return what rounding explains under a meaning.

        Where rounding decides so many shadows that a new ray tree comes with every other sample,
        no number of samples meets all of them. There the hull of the samples explains a value,
        unless the values of these pixels miss the trees that were met oftener than samples would:
        then the image is not one that rounding made.
        """
        hopeless = np.zeros(len(self._pixels), np.bool_)
        found = [self._explained(meaning, self.left, samples, hopeless) for samples in PASSES]
        found.append(self._explained(meaning, self.left[~hopeless[self.left]], LAST, hopeless))
        loose = self.left[hopeless[self.left]]
        if self._are_as_often_unmet_as_samples(meaning, spread(loose, LOOKED_AT)):
            found.append(self._take(loose))
        return np.concatenate(found)

    def are_rounded(self, meaning: Emulation, items: Items) -> Flags:
        """Say of items, taken out or not, which few samples explain under another meaning."""
        return self._sampled(meaning, items, PASSES[0])[1]

    def take_possible(self, meanings: Sequence[Emulation]) -> Items:
        """Take out and return what no meaning, or no proof, rules out rigorously."""
        impossible = [self.left[:0]]
        tried = spread(self.left, PROVEN)
        n_tried = n_impossible = 0
        for part in _rounds(tried):
            found = self._impossible(meanings, part)
            impossible.append(found)
            n_tried += len(part)
            n_impossible += len(found)
            if n_tried >= PROVEN_AT_LEAST and 50 * n_impossible < n_tried:
                break
        return self._take(np.setdiff1d(self.left, np.concatenate(impossible)))

    def _take(self, found: Items) -> Items:
        self.left = np.setdiff1d(self.left, found)
        return found

    def _explained(self, meaning: Emulation, items: Items, samples: int, hopeless: Flags) -> Items:
        """Sample some items; take out those that a box explains, and mark the hopeless ones."""
        found = [items[:0]]
        # Parts lie evenly over the image, and fit into memory with 32 bytes a sample.
        n_parts = 1 + 4 * len(items) * samples // PATIENCE
        n_tried = n_found = 0
        for k in range(n_parts):
            part = items[k::n_parts]
            seen, inside = self._sampled(meaning, part, samples)
            in_hull = seen.in_hull(self._values[part], self._room[part])
            hopeless[part] = (seen.unseen >= HOPELESS) & in_hull
            found.append(part[inside])
            n_tried += len(part)
            n_found += int(inside.sum())
            if n_tried * samples >= PATIENCE and 4 * n_found < n_tried:
                break
        return self._take(np.concatenate(found))

    def _sampled(self, meaning: Emulation, part: Items, samples: int) -> tuple[Envelope, Flags]:
        seen = envelope(
            meaning.scene, meaning.readings, pixels=self._pixels[part], error=self._error,
            samples=samples, seed=samples, threads=self._threads,
        )  # fmt: skip
        return seen, seen.contains(self._values[part], slack=self._room[part])

    def _are_as_often_unmet_as_samples(self, meaning: Emulation, items: Items) -> bool:
        """Whether the values lie in no tree's box about as often as samples would, left as they.

        These values have been missed by the samples of all passes, so that they are rare ones:
        that a sample which those missed is missed by as many as `LAST`, too, has the ratio of the
        two chances. More than three standard deviations beyond the expected number is too often;
        what is far beyond it in a part of the items already needs no further samples.
        """
        if not len(items):
            return False
        missed, expected, variance = 0, 1.0, 0.0
        for k in range(LOOKS):
            part = items[k::LOOKS]
            seen, inside = self._sampled(meaning, part, LAST)
            rare = seen.unseen_among(sum(PASSES))
            still = np.divide(seen.unseen, rare, out=np.zeros(len(part)), where=rare > 0)
            missed += int((~inside).sum())
            expected += float(still.sum())
            variance += float((still * (1 - still)).sum())
            if missed > expected + BEFORE_THE_LAST_LOOK * np.sqrt(variance):
                return False
        return bool(missed <= expected + 3 * np.sqrt(variance))

    def _impossible(self, meanings: Sequence[Emulation], items: Items) -> Items:
        for meaning in meanings:
            items = items[self._ruled_out(meaning, items)]
        return items

    def _ruled_out(self, meaning: Emulation, items: Items) -> Flags:
        """Say where no value that rounding can make lies near the given one, rigorously."""
        known = certify(
            meaning.scene, meaning.readings, pixels=self._pixels[items], kappa=self._error,
            threads=self._threads,
        )  # fmt: skip
        values, room = self._values[items], self._room[items]
        near = known.contains(values, room)
        # Where all outcomes are listed, a value between them is as wrong as one outside their
        # hull. A full list may be one cut short; without a hull it is as far as the kernel got.
        listed = known.n_alternatives
        complete = (listed > 0) & (listed < MAX_ALTERNATIVES)
        complete &= np.isfinite(known.lo[known.undecidable]).all(axis=-1)
        open_ones = np.flatnonzero(known.undecidable)
        near[open_ones] &= known.fits_alternative(values, room)[open_ones] | ~complete
        return np.asarray(~near)


def _rounds(items: Items) -> list[Items]:
    """Split items into rounds of proofs, each of them spread over all."""
    n_rounds = 1 + len(items) // ROUND
    return [items[k::n_rounds] for k in range(n_rounds)]


def spread(items: Items, most: int) -> Items:
    """Return at most so many of the items, evenly from first to last."""
    if len(items) <= most:
        return items
    return items[np.linspace(0, len(items) - 1, most).astype(np.intp)]
