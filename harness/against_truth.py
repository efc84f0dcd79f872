"""An image of anybody's held against the truth of a scene, without running any renderer."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crosstrace.harness import judging, outcome, regions
from crosstrace.harness.blame import Testimony, judge
from crosstrace.harness.classes import Classified, classify
from crosstrace.harness.lanes import REFERENCE
from crosstrace.translators.errors import UsageError
from crosstrace.translators.ledger import Arithmetic, Ledger
from crosstrace.translators.native.truth import certify
from crosstrace.translators.scene import Scene

#: Arithmetic of an image → unit of its rounding.
UNITS = {"f32": 2.0**-24, "f64": 2.0**-53}

#: Units that directions and hits of anybody's renderer may carry. Twice what native needs: a camera
#: of matrices alone, as Mitsuba's own, errs by up to 3.5 (translators/mitsuba/fidelity.py).
_KAPPA = 4.0


@dataclass(frozen=True)
class Opinion:
    """What is to be said of an image: the verdict as in a report, and what it rests on.

    `classified` has the class of every pixel; `found` describes the largest of the `n_regions`
    where it is wrong or suspect. As a text it is the verdict in words.
    """

    verdict: str
    classified: Classified
    found: tuple[regions.Region, ...]
    n_regions: int
    sentence: str

    @property
    def right(self) -> bool:
        """Whether every difference is explained."""
        return self.verdict in outcome.GOOD

    @property
    def counts(self) -> dict[str, int]:
        """Pixels of each class by its name."""
        return self.classified.counts

    def __str__(self) -> str:
        """Return the verdict in words, with the worst regions."""
        return "\n".join([f"{self.verdict}. {self.sentence}", *map(told, self.found)])


def compare_with_truth(
    image: NDArray[Any],
    scene: Scene,
    *,
    precision: str = "f64",
    half_step: float = 0.0,
    tolerance: float = 0.0,
    readings: Mapping[str, str] | None = None,
    name: str = "the image",
) -> Opinion:
    """Judge a linear image (v_res, h_res, 3), unclamped, row 0 at the top, of one scene.

    `precision` (``f32``, ``f64``) is the arithmetic that made it, `half_step` the half width of its
    quantisation (1/510 for 8 bits that were rounded), `tolerance` what else shall count as equal,
    both on linear float. Raises UsageError where the image is not of the scene's size.
    """
    values = np.asarray(image, np.float64)
    if values.shape != scene.shape:
        raise UsageError(f"expected an image of shape {scene.shape}, found {values.shape}")
    if precision not in UNITS:
        raise UsageError(f"expected a precision out of {', '.join(UNITS)}, found {precision!r}")
    unit = UNITS[precision]
    ledger = Ledger((), Arithmetic(unit, _KAPPA, unit))
    known = certify(scene, readings)
    classified = classify(
        scene, known, values, ledger, half_step=half_step + tolerance, readings=readings
    )
    verdict = judge([Testimony(name, values, classified, {})], REFERENCE, 0)
    described = judging.describe(scene, {name: values}, known, {name: classified}, readings)
    found, n_regions = described[name]
    lane = {
        "name": name, "classes": classified.counts, "n_regions": n_regions, "declared": [],
        "regions": [{"kind": one.kind, "where": one.where} for one in found],
    }  # fmt: skip
    record = {
        "verdict": verdict.word, "blame": list(verdict.blame), "expected": None,
        "renderers": [lane], "judgement": {"message": ""},
    }  # fmt: skip
    return Opinion(verdict.word, classified, tuple(found), n_regions, outcome.sentence(record))


def told(region: regions.Region | Mapping[str, Any]) -> str:
    """Say in a line where a region lies and what it looks like; one of a report does too."""
    it = region if isinstance(region, regions.Region) else _as_region(region)
    top, left, bottom, right = it.box
    pixels = "1 pixel" if it.pixels == 1 else f"{it.pixels:,} pixels"
    place = f"rows {top}-{bottom - 1}, columns {left}-{right - 1}"
    far = "not finite" if it.difference is None else f"off by {it.difference:.3g}"
    rays = f": {it.tree}" if it.tree else ""
    return (
        f"{pixels} in {place}: {it.kind} on {it.where}; worst ({it.row}, {it.column}), {far}{rays}"
    )


def _as_region(entry: Mapping[str, Any]) -> regions.Region:
    return regions.Region(**{**entry, "box": tuple(entry["box"])})
