"""POV-Ray's own settings: read, refused, and seen in the picture."""

from __future__ import annotations

import numpy as np
import pytest

from crosstrace.translators.errors import UsageError
from crosstrace.translators.native.adapter import Native
from crosstrace.translators.povray import process, tuning
from crosstrace.translators.povray.adapter import PovRay
from crosstrace.translators.renderer import RenderOptions
from crosstrace.translators.sampling import Sampling
from crosstrace.translators.scene import Scene, sphere

needs_povray = pytest.mark.skipif(not PovRay().probe().available, reason="POV-Ray is missing")


def ball() -> Scene:
    """Return a flat white ball before black."""
    return Scene.build(
        delivery=1, v_res=12, h_res=16, pixel_size=0.06, screen_distance=1.0,
        eye=np.array([0.0, -5.0, 0.0]), target=np.zeros(3), up=np.array([0.0, 0.0, 1.0]),
        background=np.zeros(3), objects=[sphere((255, 255, 255), (0.1, 0, 0.2), 1.1)],
    )  # fmt: skip


@pytest.mark.parametrize(
    ("name", "text"),
    [("antialias", "yes"), ("antialias", "nan"), ("antialias_depth", "0"), ("antialias", "-1"),
     ("antialias_depth", "2.5"), ("antialias_method", "3"), ("output_scale", "0.5"), ("x", "1")],
)  # fmt: skip
def test_settings_that_make_no_sense_are_refused(name: str, text: str) -> None:
    """The message names what was found."""
    with pytest.raises(UsageError, match=r"expected .*, found"):
        tuning.read({name: text})


def test_settings_become_switches() -> None:
    """Nothing by default; jitter stays off, so that a picture comes out the same every time."""
    assert tuning.read({}).switches == []
    read = tuning.read({"antialias": "0.1", "antialias_depth": "4", "antialias_method": "2"})
    assert read.switches == ["+AM2", "+R4", "+A0.1", "-J"]
    assert tuning.read({"output_scale": "16"}).output_scale == 16.0


@needs_povray
def test_antialiasing_comes_near_the_average_of_the_area() -> None:
    """Its picture is nearer to the mean of many samples than that of the centres, and repeats."""
    average = Native().render(ball(), RenderOptions(sampling=Sampling("regular", 32))).image
    options = RenderOptions(threads=1, tuning={"antialias": "0", "antialias_depth": "4"})
    made = PovRay().render(ball(), options)
    again = PovRay().render(ball(), options)
    plain = PovRay().render(ball(), RenderOptions(threads=1))
    assert np.array_equal(made.image, again.image)
    assert np.abs(made.image - average).max() < 0.5 * np.abs(plain.image - average).max()
    assert made.settings["rays"]["primary"] > plain.settings["rays"]["primary"] == 12 * 16


@needs_povray
def test_the_output_scale_sets_the_step() -> None:
    """A larger scale is coarser, by what it says."""
    made = PovRay().render(ball(), RenderOptions(tuning={"output_scale": "16"}))
    assert made.half_step == 16 / (2 * 65535)
    assert made.settings["tuning"] == {"output_scale": "16"}


def test_statistics_are_read_from_what_the_program_says() -> None:
    """Rays by kind and the time of tracing; nothing where it does not say."""
    text = ("Rays:              14591   Saved:   0   Max Level: 5/5\n"
            "Shadow Ray Tests:             13783   Succeeded:   4449\n"
            "Reflected Rays:                7137\nRefracted Rays:   2654\n"
            "  Trace Time:       0 hours  1 minutes  2 seconds (62.016 seconds)\n")  # fmt: skip
    counts = {"primary": 4800, "shadow": 13783, "reflected": 7137, "refracted": 2654}
    assert process.rays(text) == counts
    assert process.trace_seconds(text) == 62.016
    assert process.rays("") == {} and process.trace_seconds("") is None
