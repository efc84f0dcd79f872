"""What POV-Ray renders otherwise than the specification, scene by scene: its ledger."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from crosstrace.translators.ledger import Arithmetic, Entry, Ledger
from crosstrace.translators.povray.emulation import emulation
from crosstrace.translators.povray.output import WHITE, safe_scale
from crosstrace.translators.povray.picture import Analysis
from crosstrace.translators.povray.plan import NEGLIGIBLE
from crosstrace.translators.povray.scale import MAX_DISTANCE, MIN_DISTANCE, SHADOW_TOLERANCE
from crosstrace.translators.scene import KR, KT, N

Rows = NDArray[np.bool_] | NDArray[np.intp]


#: Hits and directions are double, colours and reflected light float32; kappa is measured. Of the
#: pixels of the 28 hard scenes 75 are suspect under a kappa of 1/4, 3 under 1/2, and one, of
#: tangent-spheres, under each of 1, 2, 3, 4 and 8; far-tiny, whose sphere POV-Ray misses, is left
#: out. None is of the 18 course scenes (120 x 160; harness/tests/test_kappa.py has some of this).
ARITHMETIC = Arithmetic(unit=2.0**-53, kappa=4.0, color_unit=2.0**-24)


def declare(analysis: Analysis) -> Ledger:
    """Declare the departures of one analysed scene, the image as a whole first."""
    return Ledger(tuple(_entries(analysis)), ARITHMETIC, emulation(analysis))


def _entries(analysis: Analysis) -> list[Entry]:
    plan, side, scale = analysis.plan, analysis.side, analysis.scale
    index, material = plan.index, plan.material
    k = safe_scale(analysis.bound)
    entries = [
        Entry("output", f"16-bit samples, output scale at most {k:g}", "approximated",
              k / (2 * WHITE)),
        Entry("arithmetic", "colours and reflected light are kept in float32", "approximated"),
    ]  # fmt: skip
    if not len(plan):
        return entries[:1]

    def add(effect: str, situation: str, rows: Rows | None = None, *readings: str) -> None:
        which = () if rows is None else tuple(int(i) for i in index[rows])
        entries.append(Entry(effect, situation, "approximated", None, which, readings))

    if not plan.sphere.all():
        limit = MAX_DISTANCE / scale
        add("geometry", f"planes end {limit:.3g} units along a ray", ~plan.sphere, "far")
    near = (np.abs(side.height) < MIN_DISTANCE / scale) & ~side.on
    if near.any():
        add("geometry", "the camera is nearer to a surface than any hit that counts", near)
    if plan.depth:
        add(
            "geometry",
            f"a secondary ray meets nothing nearer than {MIN_DISTANCE / scale:.3g}",
            None,
            "epsilon",
        )
    if len(plan.lights) and plan.shadows:
        add("shadows", f"blockers nearer than {SHADOW_TOLERANCE / scale:.3g} units to the point or "
            "to the light do not count", None, "shadow_min", "light_min")  # fmt: skip
    transparent = material[:, KT] > 0
    inexact = transparent & (material[:, N].astype(np.float32) != material[:, N])
    if inexact.any():
        add(
            "refraction",
            "indices are kept in float32, each relative to the camera",
            inexact,
            "nesting",
        )
    if len(analysis.media.nudged):
        add("refraction", "an index that does not change is taken one float32 step larger, "
            "so that the surface counts as a bounce", analysis.media.nudged,
            "nesting")  # fmt: skip
    if len(analysis.media.crossing):
        add("refraction", "transparent surfaces cross: POV-Ray keeps one index a medium, "
            "not one a surface", analysis.media.crossing, "nesting")  # fmt: skip
    if (torn := side.torn & transparent).any():
        add("refraction", "the camera lies on a transparent surface and looks to both sides", torn)
    if plan.deep:
        secondary = (material[:, KR] > 0) | transparent
        add("reflection", f"rays that carry less than {NEGLIGIBLE:g} of a pixel are left out; any "
            f"other beyond depth {plan.depth} is an error", secondary)  # fmt: skip
    return entries
