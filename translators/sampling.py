"""How a pixel is sampled: through its centre, as the specification has it, or at many points.

The value of an area is the mean of its samples. ``regular:K`` takes the centres of K × K squares of
the pixel, ``jittered:K`` a random point of each (the same ones every time), and ``adaptive:K`` four
samples a pixel, and K × K where these, or those next to them, see something else.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

from crosstrace.translators.errors import UsageError

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

Kind = Literal["centre", "regular", "jittered", "adaptive"]

#: Samples a side; the native tracer's `CT_LARGEST_CELL`.
LARGEST_SIDE = 64

#: The seed of jittered samples, unless another is stated.
SEED = 1


@dataclass(frozen=True)
class Sampling:
    """A way to sample: `side` × `side` samples a pixel; `seed` (1 or more) moves jittered ones."""

    kind: Kind = "centre"
    side: int = 1
    seed: int = SEED

    def __str__(self) -> str:
        """Return the text that `parse` reads."""
        seed = f":{self.seed}" if self.seed != SEED else ""
        return "centre" if self.kind == "centre" else f"{self.kind}:{self.side}{seed}"


CENTRE = Sampling()


def parse(text: str) -> Sampling:
    """Read ``centre``, ``regular:K``, ``adaptive:K`` or ``jittered:K[:SEED]``.

    Raises UsageError for anything else.
    """
    if text == "centre":
        return CENTRE
    kind, *numbers = text.split(":")
    most = 2 if kind == "jittered" else 1
    plain = all(n.isascii() and n.isdigit() and len(n) <= 18 for n in numbers)
    if kind in ("regular", "jittered", "adaptive") and plain and 1 <= len(numbers) <= most:
        side, seed = int(numbers[0]), int(numbers[1]) if len(numbers) > 1 else SEED
        if 1 <= side <= LARGEST_SIDE and seed >= 1:
            return Sampling(kind, side, seed)  # type: ignore[arg-type]
    expected = "centre, regular:K, jittered:K or adaptive:K"
    raise UsageError(f"sampling: expected {expected} with K from 1 to {LARGEST_SIDE}, "
                     f"found {text!r}")  # fmt: skip


def means(samples: NDArray[np.float64], side: int) -> NDArray[np.float64]:
    """Return the means of squares of `side` × `side` samples: (rows, columns, 3) to a frame."""
    rows, columns, _ = samples.shape
    blocks = samples.reshape(rows // side, side, columns // side, side, 3)
    averaged: NDArray[np.float64] = blocks.mean(axis=(1, 3))
    return averaged


def only_centre(sampling: Sampling, lane: str) -> None:
    """Raise UsageError where a lane that samples centres alone is asked for more."""
    if sampling != CENTRE:
        raise UsageError(f"{lane} traces one ray a pixel, found the sampling {sampling}")
