"""What errors are measured against; these run in a worker.

- The *certified value*: float128's, where it lies in a rigorous enclosure no wider than 1e-9 (else
  the enclosure's middle, which the platform's lack of float128 leaves). Undecidable pixels have
  none.
- A lane's *own value*: the same under the readings that it declares, so that rounding is told from
  rules of its own.
- The *deep render*: so many bounces that more change nothing that matters here.
- The *converged average* of a pixel's area: two renders of jittered samples on strata, with seeds
  that no point uses, so that their difference says how far it has converged.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crosstrace.harness.lanes import loaded
from crosstrace.harness.study.errors import Value
from crosstrace.translators.native.adapter import Native, present
from crosstrace.translators.native.truth import TOLERANCE, certify
from crosstrace.translators.renderer import RenderOptions
from crosstrace.translators.sampling import Sampling
from crosstrace.translators.scene import Scene

#: Seeds of the average's samples: points have `sampling.SEED`.
SEEDS = (1001, 1002)

#: The deep render ends at the first depth that changes no channel by more.
SETTLED = 1e-12
MOST_LEVELS = 20
#: … or that takes so many times the rays that the scene does.
MOST_GROWTH = 60.0

#: The last levels of the deep render are near enough to it that their errors say nothing.
KEPT_CLEAR = 2

#: A value of a reference, and what is known about it, JSON-ready.
Reference = tuple[Value, dict[str, Any]]


def certified(scene: Scene, threads: int) -> Reference:
    """Return the certified value of every decidable pixel."""
    known = certify(scene, threads=threads)
    counts = ~known.undecidable
    widths = (known.hi - known.lo)[counts]
    facts = {
        "undecidable": int(known.undecidable.sum()),
        "pixels": int(counts.size),
        "widest": float(widths.max()) if widths.size else None,
        "outside": 0,
        "value": "the enclosure's middle",
    }
    middle = np.where(counts[..., None], known.lo / 2 + known.hi / 2, 0.0)
    if present()[-1] != "f128":
        return Value(middle, 0.0, counts), facts
    made = Native().render(scene, RenderOptions(threads, precision="f128", layers=True))
    inside = known.contains(made.image)
    outside = counts & ~inside
    facts |= {"outside": int(outside.sum()), "value": "float128's, inside the enclosure"}
    return Value(made.image, made.layers["image_low"], counts & inside, True), facts


def own(scene: Scene, lane: str, threads: int) -> Value | None:
    """Return the certified value under a lane's own rules.

    None where it has none that show in this scene: the enclosures are those of the specification.
    """
    emulation = loaded(lane).ledger(scene).emulation
    if emulation is None:
        return None
    known = certify(emulation.scene, emulation.readings, threads=threads)
    truth = certify(scene, threads=threads)
    both = ~(known.undecidable | truth.undecidable)
    middle = known.lo / 2 + known.hi / 2
    if (np.abs(middle - (truth.lo / 2 + truth.hi / 2))[both] <= 2 * TOLERANCE).all():
        return None
    counts = ~known.undecidable
    return Value(np.where(counts[..., None], middle, 0.0), 0.0, counts)


def deep(scene: Scene, threads: int) -> tuple[Value, dict[str, Any]]:
    """Render deeper and deeper until that changes nothing, or grows out of hand."""

    def at(depth: int) -> tuple[NDArray[np.float64], int]:
        deeper = replace(scene, max_depth=depth, checked=False)
        made = Native().render(deeper, RenderOptions(threads))
        return made.image, made.n_rays or 0

    depth, change = scene.max_depth, np.inf
    image, first = at(depth)
    rays = first
    while change > SETTLED and depth < scene.max_depth + MOST_LEVELS and rays < MOST_GROWTH * first:
        depth += 1
        next_image, rays = at(depth)
        change = float(np.abs(next_image - image).max())
        image = next_image
    everywhere = np.ones(image.shape[:2], np.bool_)
    settled = change <= SETTLED
    # Bounces that bring nothing more are no reference: the last one that did is deep enough.
    facts = {"max_depth": depth, "last_change": change, "settled": settled}
    return Value(image, 0.0, everywhere), facts


def depths(scene: Scene, facts: dict[str, Any]) -> list[int]:
    """Return the numbers of bounces to try: from none to well below the deep render's."""
    last = max(scene.max_depth, facts["max_depth"] - (1 if facts["settled"] else KEPT_CLEAR))
    return list(range(last + 1))


def average(scene: Scene, side: int, threads: int) -> Reference:
    """Return the mean of two times `side`² jittered samples a pixel, and its own standard error."""
    halves = [
        Native().render(scene, RenderOptions(threads, sampling=Sampling("jittered", side, seed)))
        for seed in SEEDS
    ]
    image = (halves[0].image + halves[1].image) / 2
    apart = (halves[0].image - halves[1].image) / 2
    facts = {
        "samples": 2 * side * side,
        "standard_error_rmse": float(np.sqrt(np.mean(apart**2))),
        "standard_error_max": float(np.abs(apart).max()),
    }
    return Value(image, 0.0, np.ones(image.shape[:2], np.bool_)), facts
