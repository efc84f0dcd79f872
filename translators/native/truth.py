"""Certified pixels: rigorous enclosures of the real-arithmetic value (section 5 of the design).

The certified kernel (`native/src/set.inc.h`) is a second text beside the tracer: interval
arithmetic in double, then double-double, then float128 for what is left open. A third
(`native/src/set_stream.inc.h`) closes most pixels before, in vectors of intervals. Truth is real
arithmetic on the scene's doubles, under the default readings or any others.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from enum import IntEnum
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crosstrace.native import _core
from crosstrace.translators import readings as readings_of_the_specification
from crosstrace.translators.channels import every, largest
from crosstrace.translators.effects import effects
from crosstrace.translators.errors import RendererError, UsageError
from crosstrace.translators.renderer import Progress
from crosstrace.translators.scene import Scene

#: Widest enclosure that counts as certified, on linear float.
TOLERANCE = 1e-9

MAX_ALTERNATIVES = 16

#: A tolerance: of all pixels, or one a pixel.
Slack = float | NDArray[np.float64]


class PixelClass(IntEnum):
    """What is known of a pixel; all but the first are undecidable, for different reasons."""

    CERTIFIED = 0
    EDGE = 1
    PRECISION = 2
    BUDGET = 3


class Decision(IntEnum):
    """Which decision was open first in an undecidable pixel."""

    NONE = 0
    NEAREST = 1
    SHADOW = 2
    SIDE = 3
    TOTAL_REFLECTION = 4
    GATE = 5
    PRECISION = 6


@dataclass(frozen=True)
class Enclosures:
    """What is known of each pixel asked for; arrays have one entry a pixel, in that order.

    `lo`, `hi` (…, 3) enclose the value, or all possible values of an undecidable pixel; they are
    −∞ and ∞ where there is no enclosure. `pixel_class` and `decision` hold `PixelClass` and
    `Decision`; `depth` and `object` say where that decision was (object −1: none in particular).
    `level` is the arithmetic in which the pixel ended: 0 double, 1 double-double, 2 float128.
    `alternatives` (m, 16, 2, 3) are the enclosures [lo, hi] of the possible values of the m
    undecidable pixels, in order; the first `n_alternatives` (m,) of each count. `closed` counts the
    pixels that each arithmetic certified.
    """

    lo: NDArray[np.float64]
    hi: NDArray[np.float64]
    pixel_class: NDArray[np.uint8]
    decision: NDArray[np.uint8]
    depth: NDArray[np.int32]
    object: NDArray[np.int32]
    level: NDArray[np.uint8]
    n_alternatives: NDArray[np.uint8]
    alternatives: NDArray[np.float64]
    closed: dict[str, int]

    @property
    def undecidable(self) -> NDArray[np.bool_]:
        """Which pixels real arithmetic on the scene's doubles leaves open."""
        return np.not_equal(self.pixel_class, PixelClass.CERTIFIED)

    @property
    def certified_fraction(self) -> float:
        """The share of pixels that are certified; 1 for none."""
        return 1.0 - float(self.undecidable.mean()) if self.pixel_class.size else 1.0

    def contains(self, image: NDArray[np.float64], slack: Slack = 0.0) -> NDArray[np.bool_]:
        """Say of each pixel whether a value lies in its enclosure, widened by `slack`.

        `slack` is one number or one a pixel.
        """
        more = np.asarray(slack)[..., None]
        inside = (self.lo - more <= image) & (image <= self.hi + more)
        return every(inside)

    def fits_alternative(self, image: NDArray[np.float64], slack: Slack) -> NDArray[np.bool_]:
        """Say of each pixel whether a value fits one possible value, not merely their hull.

        `slack` is one number or one a pixel.
        """
        answer = self.contains(image, slack)
        value = image[self.undecidable][:, None, :]
        more = np.broadcast_to(slack, self.undecidable.shape)[self.undecidable][:, None, None]
        lo, hi = self.alternatives[:, :, 0] - more, self.alternatives[:, :, 1] + more
        fits = every((lo <= value) & (value <= hi))
        listed = np.arange(MAX_ALTERNATIVES) < self.n_alternatives[:, None]
        answer[self.undecidable] = (fits & listed).any(axis=-1)
        return answer

    def distance(self, image: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return how far each pixel's value lies outside of what is possible, in its worst channel.

        0 inside the enclosure, or inside an alternative of an undecidable pixel (otherwise from the
        nearest one), and where there is no enclosure; ∞ for a value that is not a number.
        """
        value = image[self.undecidable][:, None, :]
        lo, hi = self.alternatives[:, :, 0], self.alternatives[:, :, 1]
        with np.errstate(invalid="ignore"):
            far = np.maximum(largest(np.maximum(self.lo - image, image - self.hi)), 0.0)
            each = np.maximum(largest(np.maximum(lo - value, value - hi)), 0.0)
        listed = np.arange(MAX_ALTERNATIVES) < self.n_alternatives[:, None]
        nearest = np.where(listed, each, np.inf).min(axis=-1)
        far[self.undecidable] = np.where(self.n_alternatives > 0, nearest, far[self.undecidable])
        far[~every(np.isfinite(self.lo))] = 0.0
        far[~every(np.isfinite(image))] = np.inf
        return np.asarray(far)


def certify(
    scene: Scene,
    readings: Mapping[str, str] | None = None,
    *,
    pixels: NDArray[np.integer[Any]] | None = None,
    tolerance: float = TOLERANCE,
    kappa: float = 0.0,
    threads: int = 0,
    progress: Progress | None = None,
) -> Enclosures:
    """Enclose the pixels of a scene; arrays are (v_res, h_res, …), or (n, …) for n `pixels`.

    `pixels` are indices row·h_res + column, None: all. `kappa` > 0 widens everything by that
    relative error of the arithmetic under test (κ·2⁻²⁴ for a float32 renderer): the enclosures
    then hold whatever such a renderer may return, and outside them it is wrong. Raises UsageError
    for a reading that does not exist or has no meaning in real arithmetic (offset=bound).
    """
    readings = dict(readings or {})
    readings_of_the_specification.check(readings)
    if readings.get("offset") == "bound":
        raise UsageError("offset=bound has no meaning in real arithmetic: nothing to certify")
    wanted = None if pixels is None else np.ascontiguousarray(pixels, np.int64)
    shape = (scene.v_res, scene.h_res) if wanted is None else wanted.shape
    arrays = room(shape)
    settings = [*readings.items(), ("threads", str(threads)),
                ("effects", str(effects(scene, readings).overall))]  # fmt: skip
    view = scene.native_view()
    try:
        closed = _core.certify(view, settings, wanted, tolerance, kappa, arrays, progress)
        # Alternatives take 768 bytes a pixel, so only the few that need them are done again.
        left = np.flatnonzero(arrays["pixel_class"]).astype(np.int64)
        again = left if wanted is None else wanted.ravel()[left]
        some: dict[str, NDArray[Any]] = {
            "n_alternatives": np.empty(len(again), np.uint8),
            "alternatives": np.empty((len(again), MAX_ALTERNATIVES, 2, 3)),
        }
        if len(again):
            _core.certify(view, settings, again, tolerance, kappa, some, progress)
    except RuntimeError as error:
        raise RendererError(f"certification: {error}") from None
    return Enclosures(**arrays, **some, closed=closed)


def room(shape: tuple[int, ...]) -> dict[str, NDArray[Any]]:
    """Return arrays for the enclosures of so many pixels, with anything in them."""
    return {
        "lo": np.empty((*shape, 3)),
        "hi": np.empty((*shape, 3)),
        "pixel_class": np.empty(shape, np.uint8),
        "decision": np.empty(shape, np.uint8),
        "depth": np.empty(shape, np.int32),
        "object": np.empty(shape, np.int32),
        "level": np.empty(shape, np.uint8),
    }


def violations(
    scene: Scene, readings: Mapping[str, str] | None, known: Enclosures, rows: Iterable[int]
) -> int:
    """Count the pixels of some rows whose float128 value lies outside of its enclosure.

    `known` is of the whole frame. 0 on a platform without float128, where nothing is checked.
    """
    if "f128" not in _core.precisions():
        return 0
    readings = dict(readings or {})
    settings = [*readings.items(), ("precision", "f128"), ("threads", "1"),
                ("effects", str(effects(scene, readings).overall))]  # fmt: skip
    count = 0
    for row in rows:
        image = np.empty((1, scene.h_res, 3))
        span = [("row_begin", str(row)), ("row_end", str(row + 1))]
        try:
            _core.render(scene.native_view(), settings + span, {"image": image}, None)
        except RuntimeError as error:
            raise RendererError(f"certification: {error}") from None
        inside = (known.lo[row] <= image[0]) & (image[0] <= known.hi[row])
        count += int(np.count_nonzero(~every(inside)))
    return count
