"""What the two Mitsuba lanes cannot hold, and what they render otherwise than exactly."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace

import numpy as np

from crosstrace.translators.errors import UnsupportedSceneError
from crosstrace.translators.ledger import Arithmetic, Emulation, Entry, Ledger
from crosstrace.translators.mitsuba.document import (
    DISK,
    NEAR,
    WIDEST_DEGREES,
    branches,
    field_of_view,
)
from crosstrace.translators.renderer import Capabilities
from crosstrace.translators.scene import KT, N, Scene

#: Waiting rays that the recursion can hold where one hit spawns two (`recursion.STACK`).
DEEPEST = 128

#: Beyond these magnitudes squares overflow or vanish in float32 and float64.
FLOAT32_RANGE = (1e-18, 1e17)
FLOAT64_RANGE = (1e-150, 1e150)

#: The exact lane asks every object for every ray, so its time grows with their number: 4096 spheres
#: with three bounces and two lights took 8.5 s at 120x160 (two cores), eight times as long as 512,
#: and so take two minutes at 480x640. More would pass the time that an image is given.
MOST_OBJECTS_EXACT = 4096

#: How many units the directions and hits carry is measured. Mitsuba's own camera errs by up to 3.5
#: (`tests/test_arithmetic.py`). Suspect and wrong pixels of honest images of the
#: 28 hard scenes (harness/tests/test_kappa.py has some of this; of the 18 course scenes at
#: 120 x 160 there are none under any of these κ):
#:
#: | lane | κ = 1/4 | 1/2 | 1 | 2 | 3 | 4 | 8 |
#: |---|---|---|---|---|---|---|---|
#: | mitsuba | 1631 | 941 | 820 | 789 | 781 | 751 | 765 |
#: | mitsuba-f64 | 49 | 18 | 0 | 0 | 0 | 0 | 0 |
#:
#: From 1 on those of float32 are ground-1e6's, acne's and coordinates-1e6's, beside 140 of far-tiny
#: under 8.
FLOAT32 = Arithmetic(unit=2.0**-24, kappa=4.0, color_unit=2.0**-24)
FLOAT64 = Arithmetic(unit=2.0**-53, kappa=4.0, color_unit=2.0**-53)

#: Both lanes shade and recurse with the same plugins; each intersects by itself.
SHARED = {"parsing": "crosstrace", "camera": "mitsuba plugins", "shading": "mitsuba plugins",
          "recursion": "mitsuba plugins"}  # fmt: skip

_OFFSET = ("offset",)

#: From this ratio of radius to 1 on, float32 spheres are visibly wrong: 0.017 off at 1e5.
LARGE_RADIUS = 1e4


def refuse(
    lane: str, scene: Scene, effects: Collection[str], capabilities: Capabilities,
    magnitudes: tuple[float, float],
) -> None:  # fmt: skip
    """Raise UnsupportedSceneError where the lane cannot hold the scene."""
    counts = (
        ("objects", len(scene), capabilities.max_objects),
        ("pixels", scene.v_res * scene.h_res, capabilities.max_pixels),
    )
    for what, found, limit in counts:
        if limit is not None and found > limit:
            raise UnsupportedSceneError(f"{lane}: expected at most {limit} {what}, found {found}")
    if scene.max_depth > DEEPEST and branches(scene, effects):
        raise UnsupportedSceneError(
            f"{lane}: expected max_depth of at most {DEEPEST} where an object has both kr and kt,"
            f" found {scene.max_depth}"
        )
    least, most = magnitudes
    places = (scene.geometry[:, :3], scene.lights[:, 3:], scene.eye, scene.target)
    radii = scene.geometry[scene.is_sphere, 3]
    bent = scene.material[scene.material[:, KT] > 0, N]
    far = max(float(np.abs(place).max(initial=0.0)) for place in (*places, radii, bent))
    small = min(float(radii.min(initial=1.0)), float(bent.min(initial=1.0)))
    if far > most or small < least:
        raise UnsupportedSceneError(
            f"{lane}: expected magnitudes from {least:g} to {most:g},"
            f" found {far if far > most else small:g}"
        )


def ledger_f64(scene: Scene) -> Ledger:
    """Declare the exact lane: rounding, and that it cannot take many objects."""
    text = "double arithmetic, relative error a few units of 2^-53 for each operation"
    entries = [Entry("arithmetic", text, "approximated")]
    if len(scene) > MOST_OBJECTS_EXACT:
        many = f"more than {MOST_OBJECTS_EXACT} objects: every ray asks all of them"
        entries.append(Entry("geometry", many, "unsupported"))
    return Ledger(tuple(entries), FLOAT64)


def ledger_f32(scene: Scene, effects: Collection[str]) -> Ledger:
    """Declare Mitsuba's own rules: float32, its ray offsets, near plane, and wide disks."""
    entries = [
        Entry("arithmetic", "float32, relative error a few units of 2^-24", "approximated"),
        Entry("geometry", "surfaces and rays are float32 numbers; a tie may go to either object",
              "approximated", readings=("scene",)),
        Entry("camera", f"nothing nearer than {NEAR:g} along the view is seen (offset=mitsuba)",
              "approximated", readings=_OFFSET),
    ]  # fmt: skip
    if scene.delivery == 1 and field_of_view(scene) > WIDEST_DEGREES:
        wide = f"wider than {WIDEST_DEGREES:g} degrees: this project's camera and integrator"
        entries.append(Entry("camera", wide, "exact"))
    if "shadows" in effects:
        text = ("shadow rays start beside the surface along its normal, (1 + max|p|)·8.94e-5 away,"
                " and end at (1 - 8.94e-4) of the distance (offset=mitsuba)")  # fmt: skip
        entries.append(Entry("shadows", text, "approximated", readings=_OFFSET))
    for effect in ("reflection", "refraction", "total_reflection"):
        if effect in effects:
            text = "rays start beside the surface along its normal (offset=mitsuba)"
            entries.append(Entry(effect, text, "approximated", readings=_OFFSET))
    planes = tuple(map(int, np.flatnonzero(~scene.is_sphere)))
    if planes:
        text = f"planes end {DISK:g} from the foot of the perpendicular from the eye"
        entries.append(Entry("geometry", text, "approximated", objects=planes, beyond=DISK))
    large = tuple(
        map(int, np.flatnonzero(scene.is_sphere & (scene.geometry[:, 3] >= LARGE_RADIUS)))
    )
    if large:
        text = f"float32 spheres of radius {LARGE_RADIUS:g} and more lose their shadows' digits"
        entries.append(Entry("geometry", text, "approximated", objects=large))
    return Ledger(tuple(entries), FLOAT32, Emulation(_rounded(scene), {"offset": "mitsuba"}))


def _rounded(scene: Scene) -> Scene:
    """Return the scene with centres and radii of spheres as the float32 numbers that Mitsuba keeps.

    Planes are written from the foot of the perpendicular from the eye, which is near whatever is
    seen of them.
    """
    geometry = scene.geometry.copy()
    with np.errstate(over="ignore", under="ignore"):
        balls = geometry[scene.is_sphere].astype(np.float32).astype(np.float64)
    if np.isfinite(balls).all() and (balls[:, 3] > 0).all():
        geometry[scene.is_sphere] = balls
    return replace(scene, geometry=geometry, checked=False)
