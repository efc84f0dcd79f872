"""How the lanes keep the interface: effects, threads, progress, errors, settings, repeatability."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray

from crosstrace.translators.effects import effects
from crosstrace.translators.errors import RendererMissingError, UnsupportedSceneError
from crosstrace.translators.mitsuba import runtime
from crosstrace.translators.registry import renderer
from crosstrace.translators.renderer import Renderer, RenderOptions
from crosstrace.translators.scene import Scene, plane, sphere

Build = Callable[..., Scene]
Native = Callable[..., NDArray[np.float64]]

GLASS = sphere([200, 50, 50], [0, 0, 0], 1, ka=0.2, kd=0.6, ks=0.4, eta=20, kr=0.3, kt=0.5, n=1.4)
FLOOR = plane([100, 100, 200], [0, 0, -1], [0.1, 0, 2], ka=0.2, kd=0.6, ks=0.1, eta=3, kr=0.2)
LIGHTS = [([200, 200, 200], [3, -4, 5])]


@pytest.fixture
def scene(make_scene: Build) -> Scene:
    """A glass sphere over a shiny floor."""
    return make_scene(objects=[GLASS, FLOOR], lights=LIGHTS, max_depth=4)


@pytest.mark.parametrize(
    "left_out",
    ["ambient", "diffuse", "specular", "shadows", "reflection", "refraction", "total_reflection"],
)
def test_an_effect_can_be_left_out(
    left_out: str, scene: Scene, double: Renderer, native: Native
) -> None:
    """Without an effect the image is the native tracer's without it."""
    asked = frozenset(effects(scene).names) - {left_out}
    options = RenderOptions(effects=asked)
    ours = double.render(scene, options).image
    theirs = renderer("native").render(scene, options).image
    assert np.abs(ours - theirs).max() <= 1e-11


def test_both_lanes_leave_out_the_same_effects(
    scene: Scene, single: Renderer, double: Renderer
) -> None:
    """The effect mask means the same in float32."""
    options = RenderOptions(effects=frozenset({"ambient", "diffuse", "refraction"}))
    a, b = (lane.render(scene, options).image for lane in (single, double))
    assert (np.abs(a - b).max(axis=2) > 1e-3).mean() < 0.001


def test_images_do_not_depend_on_threads_or_repetition(scene: Scene, lane: Renderer) -> None:
    """One thread, two threads and a second time give the same bits."""
    images = [lane.render(scene, RenderOptions(threads=n)).image for n in (1, 2, 2)]
    assert np.array_equal(images[0], images[1])
    assert np.array_equal(images[1], images[2])


def test_a_scene_is_not_disturbed_by_the_ones_before(
    scene: Scene, make_scene: Build, lane: Renderer
) -> None:
    """Kernels that are kept from scene to scene give what a fresh one gives."""
    first = lane.render(scene, RenderOptions()).image
    for depth in (1, 7, 30):
        objects = [GLASS, FLOOR, sphere([1, 2, 3], [2, depth, 0], 1, ka=1, kr=0.5)]
        lane.render(make_scene(objects=objects, lights=LIGHTS, max_depth=depth), RenderOptions())
    assert np.array_equal(lane.render(scene, RenderOptions()).image, first)


def test_progress_ends_at_one(scene: Scene, lane: Renderer) -> None:
    """The last call says that everything is done."""
    seen: list[float] = []
    lane.render(scene, RenderOptions(), seen.append)
    assert seen == sorted(seen)
    assert seen[-1] == 1.0


def test_an_exception_from_progress_ends_the_rendering(scene: Scene, double: Renderer) -> None:
    """It comes out as it is."""

    def stop(done: float) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        double.render(scene, RenderOptions(), stop)


def test_other_readings_are_refused(scene: Scene, lane: Renderer) -> None:
    """Only the native tracer has readings; defaults given by name are accepted."""
    with pytest.raises(UnsupportedSceneError, match="plane_normal=raw"):
        lane.render(scene, RenderOptions(readings={"plane_normal": "raw"}))


def test_settings_say_how_the_image_was_made(scene: Scene, lane: Renderer) -> None:
    """Variant, precision, camera, LLVM and effects are part of the record."""
    rendering = lane.render(scene, RenderOptions())
    expected = {"variant", "precision", "camera", "integrator", "llvm", "effects"}
    assert expected <= set(rendering.settings)
    assert rendering.half_step == 0.0


def test_start_up_is_paid_once(scene: Scene, lane: Renderer) -> None:
    """A second image of the same process costs no start-up."""
    lane.render(scene, RenderOptions())
    assert lane.render(scene, RenderOptions()).seconds.startup == 0.0


def test_a_missing_mitsuba_is_said_so(scene: Scene, monkeypatch: pytest.MonkeyPatch) -> None:
    """Rendering without a usable Mitsuba raises the error that names the remedy."""

    def missing() -> None:
        raise RendererMissingError("Mitsuba cannot be imported", "pip install mitsuba")

    monkeypatch.setattr(runtime._Once, "mi", None)
    monkeypatch.setattr(runtime, "_import", missing)
    with pytest.raises(RendererMissingError, match="install it with: pip install mitsuba"):
        renderer("mitsuba").render(scene, RenderOptions())
