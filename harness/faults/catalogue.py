"""The catalogue of faults: what a self-test plants, lane by lane.

A fault is planted where its kind of mistake is made: a reading in the native tracer, the text that
a translator writes in the other lanes where that text can hold it, otherwise the scene that the
lane is given or the image that it returns. What no lane's text can hold is planted in fewer lanes.
"""

from __future__ import annotations

from crosstrace.harness.faults import document_edits, image_operations, scene_edits, sdl_edits
from crosstrace.harness.faults import situations as of
from crosstrace.harness.faults.fault import Fault, Way
from crosstrace.harness.faults.ways import (
    DocumentEdit,
    ImageOperation,
    Reading,
    SceneEdit,
    SdlEdit,
    Without,
)
from crosstrace.translators.errors import UsageError
from crosstrace.translators.registry import LANES

_MITSUBA = ("mitsuba", "mitsuba-f64")


def _everywhere(way: Way, **instead: Way) -> dict[str, Way]:
    """Plant in every lane one way, in those named another; `mitsuba` names both of its lanes."""
    return {lane: instead.get(lane.partition("-")[0], way) for lane in LANES}


def _in(lanes: tuple[str, ...], way: Way) -> dict[str, Way]:
    return dict.fromkeys(lanes, way)


FAULTS: tuple[Fault, ...] = (
    Fault(
        "epsilon-zero",
        "Rays start on the surface itself, and may hit it again.",
        of.offsets,
        {"native": Reading({"epsilon": "0"})},
    ),
    Fault(
        "no-shadow",
        "Nothing casts a shadow.",
        of.calls_for("shadows"),
        _everywhere(Without("shadows"), povray=SdlEdit(sdl_edits.without_shadows)),
    ),
    Fault(
        "glass-lets-light-through",
        "Transparent objects cast no shadow.",
        of.glass_shades,
        {
            "native": Reading({"glass_shadow": "clear"}),
            "povray": SdlEdit(sdl_edits.without_shadow_twins),
        },
    ),
    Fault(
        "glass-filters-light",
        "Transparent objects cast POV-Ray's own shadow, filtered by their colour.",
        of.glass_shades,
        {"povray": SdlEdit(sdl_edits.filtered_shadows)},
    ),
    Fault(
        "n-inverted",
        "The index of refraction is taken for its inverse.",
        of.bends,
        _everywhere(
            SceneEdit(scene_edits.indices_inverted), native=Reading({"refraction": "inverted"})
        ),
    ),
    Fault(
        "one-bounce-fewer",
        "The recursion ends one bounce too early.",
        of.bounces,
        _everywhere(
            Reading({"depth": "minus-one"}),
            mitsuba=DocumentEdit(document_edits.one_bounce_fewer),
            povray=SdlEdit(sdl_edits.one_level_fewer),
        ),
    ),
    Fault(
        "one-bounce-more",
        "The recursion ends one bounce too late.",
        of.would_bounce_deeper,
        _everywhere(SceneEdit(scene_edits.one_bounce_more), native=Reading({"depth": "plus-one"})),
    ),
    Fault(
        "normals-flipped",
        "Normals point to the other side: those of planes, in lane mitsuba those of spheres too.",
        of.calls_for("diffuse", "specular", "refraction"),
        {
            **_everywhere(SceneEdit(scene_edits.planes_turned)),
            "mitsuba": DocumentEdit(document_edits.normals_turned),
        },
    ),
    Fault(
        "no-total-reflection",
        "Where no refracted ray exists nothing takes its place.",
        of.calls_for("total_reflection"),
        {
            "native": Reading({"tir": "ignore"}),
            **_in(_MITSUBA, DocumentEdit(document_edits.without_total_reflection)),
        },
    ),
    Fault(
        "gain-1-percent",
        "The image is 1 % too bright.",
        of.always,
        _everywhere(ImageOperation(image_operations.brighter)),
    ),
    Fault(
        "half-pixel-shift",
        "The image lies half a pixel to the right: resampled, in lane povray by the camera's rays.",
        of.always,
        _everywhere(
            ImageOperation(image_operations.half_pixel_right),
            povray=SdlEdit(sdl_edits.half_pixel_right),
        ),
    ),
    Fault(
        "camera-turned-half-a-pixel",
        "The camera looks half a pixel past its target.",
        of.always,
        _everywhere(SceneEdit(scene_edits.half_pixel_turn)),
    ),
    Fault(
        "clamp-instead-of-scale",
        "Values beyond 1 are cut, component by component.",
        of.always,
        _everywhere(ImageOperation(image_operations.clamped)),
    ),
    Fault(
        "srgb-applied",
        "The image is encoded for a screen.",
        of.always,
        _everywhere(ImageOperation(image_operations.srgb)),
    ),
    Fault(
        "gamma-decoded",
        "Colours are taken as encoded with gamma 2.2 and decoded.",
        of.always,
        {"povray": SdlEdit(sdl_edits.decoded_gamma)},
    ),
    Fault(
        "image-mirrored",
        "Left and right are swapped.",
        of.always,
        _everywhere(ImageOperation(image_operations.mirrored), povray=SdlEdit(sdl_edits.mirrored)),
    ),
    Fault(
        "u-and-v-swapped",
        "The camera takes u for v: a quarter turn, in lane povray a true swap.",
        of.always,
        _everywhere(SceneEdit(scene_edits.quarter_turn), povray=SdlEdit(sdl_edits.axes_swapped)),
    ),
    Fault(
        "one-object-missing",
        "An object that can be seen is left out.",
        of.always,
        _everywhere(SceneEdit(scene_edits.without_an_object)),
    ),
    Fault(
        "last-object-unwritten",
        "The translator stops one object too early.",
        of.always,
        {
            **_in(_MITSUBA, DocumentEdit(document_edits.without_the_last_object)),
            "povray": SdlEdit(sdl_edits.without_the_last_object),
        },
    ),
    Fault(
        "one-light-missing",
        "The first light that is not black is left out.",
        of.calls_for("diffuse", "specular"),
        _everywhere(
            SceneEdit(scene_edits.without_a_light),
            mitsuba=DocumentEdit(document_edits.without_a_light),
        ),
    ),
    Fault(
        "light-moved-1e-2",
        "The first light that is not black stands 0.01 units away from its place.",
        of.calls_for("diffuse", "specular"),
        _everywhere(SceneEdit(scene_edits.light_moved)),
    ),
    Fault(
        "eta-plus-one",
        "Every highlight's exponent is one too large.",
        of.calls_for("specular"),
        _everywhere(SceneEdit(scene_edits.exponents_off), povray=SdlEdit(sdl_edits.exponents_off)),
    ),
    Fault(
        "kd-times-1.002",
        "Every diffuse coefficient is 0.2 % off.",
        of.calls_for("diffuse"),
        _everywhere(SceneEdit(scene_edits.diffuse_off)),
    ),
    Fault(
        "n-times-1.001",
        "Every index of refraction is 0.1 % off.",
        of.calls_for("refraction"),
        _everywhere(SceneEdit(scene_edits.indices_off)),
    ),
    Fault(
        "radius-times-1.001",
        "Every sphere is 0.1 % too wide.",
        of.always,
        _everywhere(
            SceneEdit(scene_edits.radii_off), mitsuba=DocumentEdit(document_edits.radii_off)
        ),
    ),
    Fault(
        "index-as-given",
        "An object's n is written as an absolute index, whatever it is nested in.",
        of.bends,
        {"povray": SdlEdit(sdl_edits.indices_as_given)},
    ),
    Fault(
        "adc-bailout-default",
        "Rays that carry less than 1/255 of a pixel are left out.",
        of.bounces,
        {"povray": SdlEdit(sdl_edits.default_bailout)},
    ),
)

_BY_NAME = {known.name: known for known in FAULTS}


def fault(name: str) -> Fault:
    """Return a fault; raises UsageError for an unknown name."""
    if name not in _BY_NAME:
        raise UsageError(f"expected a fault out of {', '.join(_BY_NAME)}, found {name!r}")
    return _BY_NAME[name]


def plantings(lane: str) -> tuple[Fault, ...]:
    """Return the faults that can be planted in a lane, in the order of the catalogue."""
    return tuple(known for known in FAULTS if lane in known.ways)
