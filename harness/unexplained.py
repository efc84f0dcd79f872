"""The pixels of one image that nothing has explained yet, and what explains them.

A value is explained by a *meaning* of the scene (the specification's, or a lane's habits) where
that meaning encloses it, or where honest arithmetic of the lane's kind may return it (the sampled
envelope of `translators/native/conditioning.py`). What is left is impossible, or merely unlikely.

Sampling is spent where it pays: few samples for all pixels, many for few. Where most of a spread
choice of pixels stays unexplained, the image is wrong as a whole, and the rest is not tried.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from crosstrace.translators.ledger import Arithmetic, Emulation
from crosstrace.translators.native.conditioning import COLOR_UNITS, envelope, impossible
from crosstrace.translators.native.truth import certify

Pixels = NDArray[np.intp]
Array = NDArray[np.float64]

#: Samples of each pass, and the most pixels that are tried in it.
PASSES = ((16, 1 << 62), (128, 2048), (1024, 128), (4096, 32))

#: Pixels of the spread choice, and the share of it that has to be explained.
_SPREAD, _WORTH_TRYING = 4096, 0.5

#: At most so many pixels are proven impossible one by one; others stay merely unexplained.
_PROVEN = 1 << 15

#: Samples that are kept in memory at once, 32 bytes each.
_SAMPLES = 1 << 20


class Unexplained:
    """`pixels` (flat indices) of an image with `values` (n_pixels, 3) and tolerances `slack`."""

    def __init__(
        self, pixels: Pixels, values: Array, slack: Array, arithmetic: Arithmetic, threads: int
    ) -> None:
        """Begin with these pixels."""
        self.pixels = pixels
        largest = np.maximum(1.0, np.abs(values).max(axis=-1))
        self._values, self._slack = values, slack
        self._room = slack + COLOR_UNITS * arithmetic.color_unit * largest
        self._error, self._threads = arithmetic.error, threads

    def take_enclosed(self, meaning: Emulation) -> Pixels:
        """Take out and return the pixels whose value is certified under a meaning."""
        if not len(self.pixels):
            return self.pixels
        known = certify(meaning.scene, meaning.readings, pixels=self.pixels, threads=self._threads)
        enclosed = np.isfinite(known.lo).all(axis=-1)
        values, slack = self._values[self.pixels], self._slack[self.pixels]
        return self._take(self.pixels[enclosed & known.fits_alternative(values, slack)])

    def take_rounded(self, meanings: Sequence[Emulation]) -> Iterator[tuple[Pixels, int]]:
        """Take out what rounding explains: yields pixels and the index of the meaning.

        The first meaning goes first while samples are few; where they are many, the last does, as
        the more probable cause of what is left.
        """
        for seed, (samples, most) in enumerate(PASSES):
            order = range(len(meanings)) if seed == 0 else reversed(range(len(meanings)))
            for which in order:
                found = self._rounded(meanings[which], samples, most, seed)
                if len(found):
                    yield self._take(found), which

    def take_possible(self, meanings: Sequence[Emulation]) -> Pixels:
        """Take out and return the pixels that no meaning rules out rigorously."""
        tried = _spread(self.pixels, _PROVEN)
        for meaning in meanings:
            if len(tried):
                ruled_out = impossible(
                    meaning.scene, self._values[tried], pixels=tried, error=self._error,
                    readings=meaning.readings, room=self._room[tried], threads=self._threads,
                )  # fmt: skip
                tried = tried[ruled_out]
        return self._take(np.setdiff1d(self.pixels, tried))

    def _take(self, found: Pixels) -> Pixels:
        self.pixels = np.setdiff1d(self.pixels, found)
        return found

    def _rounded(self, meaning: Emulation, samples: int, most: int, seed: int) -> Pixels:
        tried = _spread(self.pixels, most)
        first = _spread(tried, _SPREAD)
        found = self._inside(meaning, first, samples, seed)
        if len(first) == len(tried) or len(found) < _WORTH_TRYING * len(first):
            return found
        rest = np.setdiff1d(tried, first)
        return np.union1d(found, self._inside(meaning, rest, samples, seed))

    def _inside(self, meaning: Emulation, tried: Pixels, samples: int, seed: int) -> Pixels:
        found = [tried[:0]]
        for part in np.array_split(tried, 1 + len(tried) * samples // _SAMPLES):
            seen = envelope(
                meaning.scene, meaning.readings, pixels=part, error=self._error,
                samples=samples, seed=seed, threads=self._threads,
            )  # fmt: skip
            inside = seen.contains(self._values[part], slack=self._room[part])
            found.append(part[inside])
        return np.concatenate(found)


def _spread(items: Pixels, most: int) -> Pixels:
    """Return at most so many of the items, evenly from first to last."""
    if len(items) <= most:
        return items
    return items[np.linspace(0, len(items) - 1, most).astype(np.intp)]
