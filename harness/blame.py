"""Who is wrong, and what is said of a scene as a whole (section 5 of the design).

The truth is not believed by decree. It rests on the certified kernel, a second text beside the
native tracer, but both have one meaning of a scene. So a lane is blamed for pixels that are
impossible, and the reference where it leaves its own enclosure, or where independent lanes agree
with each other against both. Lanes are independent in a stage where different code does it; two
that share the code of a stage are one witness there.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from crosstrace.harness.classes import Class, Classified
from crosstrace.translators.channels import largest
from crosstrace.translators.renderer import STAGES

#: Of the pixels of an image, beside the fixed number, may be suspect or undecidable.
SUSPECT_PIXELS, SUSPECT_SHARE, UNDECIDABLE_SHARE = 8, 1e-4, 0.05

#: Witnesses against the reference must be independent where the picture is made.
_JUDGED_STAGES = ("intersection", "shading", "recursion")


@dataclass(frozen=True)
class Testimony:
    """One lane's image (v_res, h_res, 3), its classes, and who does each of its stages."""

    lane: str
    image: NDArray[np.float64]
    classified: Classified
    stages: Mapping[str, str]

    def maker(self, stage: str) -> str:
        """Return whose code does a stage: the lane's own unless it is shared."""
        return self.stages.get(stage, self.lane)


@dataclass(frozen=True)
class Verdict:
    """`word` as in a report; `blame` the lanes at fault, worst first; `against` counts the pixels
    where independent lanes agree with each other against the reference."""

    word: str
    blame: tuple[str, ...]
    against: int


def suspects_allowed(n_pixels: int) -> int:
    """Return how many suspect pixels an image may have."""
    return max(SUSPECT_PIXELS, int(SUSPECT_SHARE * n_pixels))


def judge(
    testimonies: Sequence[Testimony], reference: str, violations: int, like_reference: bool = True
) -> Verdict:
    """Give the verdict of a scene of which every lane has an image.

    `violations` counts pixels whose float128 value leaves its enclosure. `like_reference`: the
    other lanes were asked for the same reading of the specification as the reference, so that
    their agreement can speak against it.
    """
    against = _agreed_against(testimonies, reference) if like_reference else 0
    n_pixels = testimonies[0].classified.classes.size if testimonies else 0
    own = [t for t in testimonies if t.lane == reference and faults(t.classified)]
    if violations or own or against > suspects_allowed(n_pixels):
        return Verdict("reference-broken", (reference,), against)
    guilty = [t for t in testimonies if faults(t.classified)]
    guilty.sort(key=lambda t: -faults(t.classified))
    if guilty or any(_is_open(t.classified) for t in testimonies):
        return Verdict("disagree", tuple(t.lane for t in guilty), against)
    clean = all(t.classified.counts["equal"] == n_pixels for t in testimonies)
    return Verdict("agree" if clean else "explained", (), against)


def faults(classified: Classified) -> int:
    """Return how many pixels speak against a lane: wrong ones, and suspects beyond the cap."""
    wrong, suspect = classified.counts["wrong"], classified.counts["suspect"]
    return wrong + (suspect if suspect > suspects_allowed(classified.classes.size) else 0)


def _is_open(classified: Classified) -> bool:
    share = UNDECIDABLE_SHARE * classified.classes.size
    return classified.counts["undecidable"] > share


def independent(a: Testimony, b: Testimony) -> bool:
    """Say whether two lanes share no code of the stages that make a picture."""
    return all(a.maker(stage) != b.maker(stage) for stage in _JUDGED_STAGES)


def _agreed_against(testimonies: Sequence[Testimony], reference: str) -> int:
    """Count pixels where independent lanes have one value, which truth calls impossible."""
    others = [t for t in testimonies if t.lane != reference]
    agreed = None
    for a, b in combinations(others, 2):
        if not independent(a, b):
            continue
        both = a.classified.pixels(Class.WRONG) & b.classified.pixels(Class.WRONG)
        room = 4 * (a.classified.tolerance + b.classified.tolerance)
        if both.any():
            both &= largest(np.abs(a.image - b.image)) <= room
        agreed = both if agreed is None else agreed | both
    return 0 if agreed is None else int(np.count_nonzero(agreed))


def table(testimonies: Sequence[Testimony]) -> dict[str, dict[str, str]]:
    """Return stage → lane → who does it: what is shared counts once."""
    return {stage: {t.lane: t.maker(stage) for t in testimonies} for stage in STAGES}
