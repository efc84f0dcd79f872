"""One fault planted in several lanes is the same mistake: the faulty images agree too.

The ways differ (a reading here, an edited text there), so each proves the other.
"""

from __future__ import annotations

import numpy as np
import pytest
from fault_examples import OPTIONS, honest, need, small

from crosstrace.harness.faults import changed_pixels, fault, render_here

#: The same in every lane of double precision that can have them.
ALIKE = (
    "no-shadow", "glass-lets-light-through", "n-inverted", "one-bounce-fewer", "one-bounce-more",
    "no-total-reflection", "one-object-missing", "one-light-missing", "eta-plus-one",
    "image-mirrored", "radius-times-1.001",
)  # fmt: skip


BOUNDS = {"mitsuba-f64": 1e-11, "povray": 1e-6}


@pytest.mark.parametrize(
    ("lane", "name"),
    [(lane, name) for lane in BOUNDS for name in ALIKE if lane in fault(name).lanes],
)
def test_a_fault_makes_the_image_that_it_makes_in_the_native_tracer(lane: str, name: str) -> None:
    """To the precision of the honest lane, while it is far from the honest image."""
    need(lane)
    scene = small("bolha4")
    here, there = (render_here(name, which, scene, OPTIONS) for which in ("native", lane))
    assert here is not None
    assert there is not None
    apart = np.abs(here.image - there.image).max()
    assert apart <= there.half_step + BOUNDS[lane]
    assert changed_pixels(lane, honest(lane, "bolha4"), there) > 20


@pytest.mark.parametrize(
    "name",
    ["no-total-reflection", "one-bounce-fewer", "one-light-missing", "radius-times-1.001"],
)
def test_a_fault_in_mitsuba_s_document_is_the_native_one_up_to_mitsuba_s_own_rules(
    name: str,
) -> None:
    """Of 4,800 pixels fewer leave native than 2 %, as of the honest images."""
    need("mitsuba")
    here, there = (
        render_here(name, which, small("bolha4"), OPTIONS) for which in ("native", "mitsuba")
    )
    assert here is not None
    assert there is not None
    apart = np.abs(here.image - there.image).max(axis=2)
    assert (apart > 1e-4).mean() < 0.02
    assert changed_pixels("mitsuba", honest("mitsuba", "bolha4"), there) > 100


def test_povray_swaps_the_axes_and_so_mirrors_the_native_quarter_turn() -> None:
    """u for v and v for u is a quarter turn and a mirror."""
    need("povray")
    here, there = (
        render_here("u-and-v-swapped", which, small("bolha4"), OPTIONS)
        for which in ("native", "povray")
    )
    assert here is not None
    assert there is not None
    assert np.abs(here.image[:, ::-1] - there.image).max() <= there.half_step + 1e-6


@pytest.mark.parametrize(
    ("name", "scene"),
    [
        ("glass-filters-light", "bolha4"),
        ("gamma-decoded", "bolha4"),
        ("last-object-unwritten", "bolha4"),
        ("half-pixel-shift", "bolha4"),
        ("adc-bailout-default", "espelho3"),
        ("index-as-given", "nested-glass"),
    ],
)
def test_a_fault_of_povray_s_text_alone_shows(name: str, scene: str) -> None:
    """More than 20 pixels change, and POV-Ray renders what it reads."""
    need("povray")
    made = render_here(name, "povray", small(scene), OPTIONS)
    assert made is not None
    assert changed_pixels("povray", honest("povray", scene), made) > 20


@pytest.mark.parametrize("lane", ["mitsuba", "mitsuba-f64"])
@pytest.mark.parametrize("name", ["last-object-unwritten", "normals-flipped"])
def test_a_fault_of_mitsuba_s_document_alone_shows(lane: str, name: str) -> None:
    """More than 20 pixels change."""
    need(lane)
    made = render_here(name, lane, small("bolha4"), OPTIONS)
    assert made is not None
    assert changed_pixels(lane, honest(lane, "bolha4"), made) > 20
