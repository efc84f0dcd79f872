"""Whether an image departs from truth in as many pixels as rounding would have it depart.

Each pixel alone may be what rounding returns, and the image may not: at float32 a shadow ray may
meet its own surface in any pixel, but not in all of them, as if a light were left out, nor only
where a ray less was traced. Independent chances add up: of n pixels with chances p, Σp ± √Σp(1-p)
depart.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from crosstrace.translators.ledger import Arithmetic, Emulation
from crosstrace.translators.native.envelope import envelope
from crosstrace.translators.native.truth import Enclosures

#: Pixels that are sampled, evenly over the image, and samples of each.
PIXELS, SAMPLES = 2048, 32

#: A renderer's own roundings are not the samples': their number may be off by this share and so
#: many standard deviations. POV-Ray's speckle behind a light that lies on a sphere has 710 pixels
#: of an expected 712; a light left out 868 instead of 184, a bounce left out 397 instead of 2660.
#: The samples' error is a bound: honest float32 has 107 instead of 146 in `terra`, but 18 instead
#: of 302 in `espelho3`. So too few speak against an image only where better is known of its
#: renderer than this meaning, as of a lane that declares habits.
SHARE, DEVIATIONS = 0.25, 4.0


def as_often_as_samples(
    meaning: Emulation,
    known: Enclosures,
    departing: NDArray[np.bool_],
    slack: NDArray[np.float64],
    arithmetic: Arithmetic,
    threads: int = 0,
) -> bool:
    """Whether as many of the pixels are `departing` (v_res, h_res) as samples of rounding depart.

    Meant for what a lane's declared habits leave unexplained; see `SHARE` for why not otherwise.
    `known` encloses the whole frame under the meaning, `slack` (v_res, h_res) is the difference
    that counts as none. Undecidable pixels do not count.
    """
    certain = np.flatnonzero(~known.undecidable)
    pixels = certain[:: 1 + len(certain) // PIXELS]
    if not len(pixels):
        return True
    seen = envelope(
        meaning.scene, meaning.readings, pixels=pixels, error=arithmetic.error, samples=SAMPLES,
        seed=SAMPLES, threads=threads,
    )  # fmt: skip
    room = slack.ravel()[pixels][:, None, None]
    low, high = (side.reshape(-1, 3)[pixels][:, None, :] for side in (known.lo, known.hi))
    outside = ((seen.colors < low - room) | (seen.colors > high + room)).any(axis=-1)
    chance = outside.mean(axis=1)
    expected, deviation = chance.sum(), np.sqrt((chance * (1 - chance)).sum())
    found = np.count_nonzero(departing.ravel()[pixels])
    return bool(abs(found - expected) <= SHARE * expected + DEVIATIONS * deviation + 1)
