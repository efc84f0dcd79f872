"""What is to be said of each pixel of one lane's image, against the truth.

In this order, each pixel in the first class that it fits (section 5 of the design):

| class | the lane's value |
|---|---|
| ``equal`` | lies in the certified enclosure, give or take the lane's tolerance |
| ``undecidable`` | is one of the possible ones where real arithmetic leaves the pixel open |
| ``rounding`` | is what an honest renderer of the lane's arithmetic and habits may return |
| ``model`` | is neither, but both under the lane's declared habits: the ledger is proven here |
| ``suspect`` | no sample of such arithmetic returns it, but the proof that none can is missing |
| ``wrong`` | is impossible under the specification and under the declared habits |

The tolerance is the lane's quantisation and 16 roundings of its colours. Only the pixels beyond it
are looked at further, and habits are tried before rounding: they are the cheaper proof, and where
habits alone explain a value its rounding is not in question. A lane that declares habits rounds
under these. Where only rounding under the specification itself explains a value (a shadow ray that
meets its own surface at float32), it must explain the image, too: one that departs from truth more
often than such rounding would, or less, has another cause, and these pixels are ``suspect``.

An undecidable pixel without an enclosure is ``undecidable`` whatever its value: the caps on that
class are what bounds it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import IntEnum
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crosstrace.translators.channels import every, largest
from crosstrace.translators.ledger import Arithmetic, Emulation, Ledger
from crosstrace.translators.native.departures import as_often_as_samples
from crosstrace.translators.native.truth import Enclosures
from crosstrace.translators.native.unexplained import Unexplained
from crosstrace.translators.scene import Scene

#: Roundings of a colour that count as quantisation: sums of some lights, products of bounces.
COLOR_UNITS = 16


class Class(IntEnum):
    """The classes; the names in a record are these in lower case."""

    EQUAL = 0
    ROUNDING = 1
    UNDECIDABLE = 2
    MODEL = 3
    SUSPECT = 4
    WRONG = 5


NAMES = tuple(kind.name.lower() for kind in Class)


@dataclass(frozen=True)
class Classified:
    """The classes of an image, (v_res, h_res), or of n of its pixels, and what they rest on.

    `tolerance` is the greatest difference on linear float that counts as none, shaped alike;
    `tolerance_at_one` the same of a pixel of value 1 or less.
    """

    classes: NDArray[np.uint8]
    tolerance: NDArray[np.float64]
    tolerance_at_one: float

    @property
    def counts(self) -> dict[str, int]:
        """Pixels of each class by its name."""
        numbers = np.bincount(self.classes.ravel(), minlength=len(NAMES))
        return {name: int(n) for name, n in zip(NAMES, numbers, strict=True)}

    def pixels(self, *kinds: Class) -> NDArray[np.bool_]:
        """Say which pixels are of one of these classes, (v_res, h_res)."""
        return np.asarray(np.isin(self.classes, kinds))


def tolerance(
    image: NDArray[np.float64], arithmetic: Arithmetic, half_step: float
) -> NDArray[np.float64]:
    """Return what counts as equal, pixel by pixel: quantisation, and roundings of the colours."""
    size = np.maximum(1.0, largest(np.abs(image)))
    return np.asarray(half_step + COLOR_UNITS * arithmetic.color_unit * size)


def classify(
    scene: Scene,
    truth: Enclosures,
    image: NDArray[np.float64],
    ledger: Ledger,
    *,
    half_step: float = 0.0,
    readings: Mapping[str, str] | None = None,
    threads: int = 0,
    pixels: NDArray[np.integer[Any]] | None = None,
) -> Classified:
    """Class every pixel of a lane's linear image (v_res, h_res, 3).

    `truth` encloses the whole frame under `readings`. `half_step` is that of the lane's output.
    With `pixels` (n,), row·h_res + column, image (n, 3), truth and classes are of these alone.
    """
    finite = every(np.isfinite(image))
    values = np.where(finite[..., None], image, 0.0)
    slack = tolerance(values, ledger.arithmetic, half_step)
    classes = np.full(image.shape[:-1], Class.WRONG, np.uint8)
    fits = fits_enclosure(truth, values, slack) & finite
    classes[fits & ~truth.undecidable] = Class.EQUAL
    classes[fits & truth.undecidable] = Class.UNDECIDABLE
    differing = np.flatnonzero(~fits & finite)
    left = Unexplained(
        differing if pixels is None else pixels[differing],
        values.reshape(-1, 3)[differing],
        slack.ravel()[differing],
        ledger.arithmetic,
        threads,
    )
    flat = classes.reshape(-1)
    specified = Emulation(scene, readings or {})
    own = ledger.emulation or specified
    if ledger.emulation is not None:
        flat[differing[left.take_enclosed(own)]] = Class.MODEL
    left.drop_impossible([specified, own])
    rounded = left.take_rounded(own)
    both = rounded if own is specified else rounded[left.are_rounded(specified, rounded)]
    flat[differing[rounded]] = Class.MODEL
    flat[differing[both]] = Class.ROUNDING
    if own is not specified and len(left.left):
        departing = np.zeros(classes.shape, np.bool_)
        departing.reshape(-1)[differing[left.left]] = True
        if as_often_as_samples(specified, truth, departing, slack, ledger.arithmetic, threads):
            flat[differing[left.take_rounded(specified)]] = Class.ROUNDING
    flat[differing[left.take_possible([specified, own])]] = Class.SUSPECT
    # Which of the possible values rounding led to is open where truth itself is.
    flat[(flat == Class.ROUNDING) & truth.undecidable.ravel()] = Class.UNDECIDABLE
    at_one = float(tolerance(np.ones(3), ledger.arithmetic, half_step))
    return Classified(classes, slack, at_one)


def fits_enclosure(
    known: Enclosures, values: NDArray[np.float64], slack: NDArray[np.float64]
) -> NDArray[np.bool_]:
    """Say which values lie in their enclosure, or in one alternative of an undecidable pixel.

    Without an enclosure nothing speaks against a value.
    """
    enclosed = every(np.isfinite(known.lo))
    return np.asarray(~enclosed | known.fits_alternative(values, slack))
