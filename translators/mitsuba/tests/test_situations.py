"""Scenes at the edges of the format through both lanes, against the native tracer."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from crosstrace.translators.renderer import Renderer, RenderOptions
from crosstrace.translators.scene import Scene, plane, sphere

Native = Callable[..., NDArray[np.float64]]
Build = Callable[..., Scene]

GLASS = sphere([200, 50, 50], [0, 0, 0], 1, ka=0.2, kd=0.6, ks=0.4, eta=20, kr=0.3, kt=0.5, n=1.4)
MIRROR = sphere([50, 200, 50], [1.5, 1, 0.2], 0.8, ka=0.2, kd=0.6, ks=0.4, eta=7.3, kr=0.3)
FLOOR = plane([100, 100, 200], [0, 0, -1], [0.1, 0, 2], ka=0.2, kd=0.6, ks=0.1, eta=3, kr=0.2)
WALL = plane([200, 100, 20], [0, 5, 0], [0, -1, 0], ka=0.2, kd=0.6)
SPHERES, PLANES = [GLASS, MIRROR], [FLOOR, WALL]
LIGHTS = [([200, 200, 200], [3, -4, 5]), ([90, 50, 20], [-3, -1, 2])]

CASES: dict[str, dict[str, Any]] = {
    "no objects": {"lights": LIGHTS, "max_depth": 3},
    "no lights": {"objects": SPHERES + PLANES, "max_depth": 3},
    "nothing": {},
    "max_depth 0": {"objects": SPHERES + PLANES, "lights": LIGHTS},
    "max_depth 5": {"objects": SPHERES + PLANES, "lights": LIGHTS, "max_depth": 5},
    "planes only": {"objects": PLANES, "lights": LIGHTS, "max_depth": 2},
    "spheres only": {"objects": SPHERES, "lights": LIGHTS, "max_depth": 4},
    "one pixel": {"objects": SPHERES, "lights": LIGHTS, "max_depth": 4, "v_res": 1, "h_res": 1},
    "one row": {"objects": PLANES, "lights": LIGHTS, "max_depth": 4, "v_res": 1, "h_res": 7},
    "delivery 2": {"delivery": 2, "objects": [WALL, sphere([9, 99, 9], [0, 0, 0], 1, kd=0.5)],
                   "lights": LIGHTS},
    "the same light three times": {"objects": PLANES, "lights": LIGHTS * 3, "max_depth": 1},
    "a light inside a sphere": {"objects": SPHERES + PLANES, "max_depth": 2,
                                "lights": [([200, 200, 200], [0, 0, 0])]},
    "total reflection without kr": {
        "objects": [sphere([20, 50, 50], [0, 0, 0], 1.5, ks=0.4, eta=20, kt=0.9, n=0.5), *PLANES],
        "lights": LIGHTS, "max_depth": 4},
    "sharp and dull highlights": {
        "objects": [sphere([200, 50, 50], [0, 0, 0], 1, ks=1, eta=1e4),
                    sphere([0, 50, 50], [2, 0, 0], 1, ks=1, eta=0.01), FLOOR], "lights": LIGHTS},
    "the eye at a sphere's centre": {
        "objects": [sphere([20, 50, 50], [0, -6, 1], 1, ka=0.2, kr=0.2, kt=0.7, n=1.5), *PLANES],
        "lights": LIGHTS, "max_depth": 5},
    "the eye on a plane": {"objects": [plane([9, 9, 9], [3, -6, 2], [0, 1, 0], ka=1), *SPHERES],
                           "lights": LIGHTS},
    "the eye on a sphere": {"objects": [sphere([9, 9, 9], [0, -7, 1], 1, ka=1), *SPHERES],
                            "lights": LIGHTS},
    "twins": {"objects": [FLOOR, GLASS, plane([0, 250, 0], [0, 0, -1], [0.1, 0, 2], ka=1),
                          sphere([0, 0, 250], [0, 0, 0], 1, ka=1), GLASS],
              "lights": LIGHTS, "max_depth": 2},
}  # fmt: skip


@pytest.mark.parametrize("case", CASES)
def test_the_exact_lane_equals_native(
    case: str, make_scene: Build, double: Renderer, native: Native
) -> None:
    """In every situation the two differ by no more than double arithmetic makes them."""
    scene = make_scene(**CASES[case])
    image = double.render(scene, RenderOptions()).image
    assert image.shape == scene.shape
    assert np.abs(image - native(scene)).max() <= 1e-11


@pytest.mark.parametrize("case", CASES)
def test_float32_equals_native_under_mitsubas_offset(
    case: str, make_scene: Build, single: Renderer, native: Native
) -> None:
    """In every situation Mitsuba's offset rules leave nothing but rounding to float32."""
    scene = make_scene(**CASES[case])
    image = single.render(scene, RenderOptions()).image
    assert image.shape == scene.shape
    assert np.abs(image - native(scene, offset="mitsuba")).max() <= 1e-4


@pytest.mark.parametrize("lights", [[([200, 200, 200], [0, 0, -1])], [([99, 99, 99], [1, 5, 0])]])
def test_a_light_on_a_plane_lights_what_it_sees(
    lights: list[Any], make_scene: Build, double: Renderer, native: Native
) -> None:
    """A blocker at exactly the light does not block: the limit short of it decides nothing else."""
    scene = make_scene(objects=PLANES, lights=lights)
    # Mitsuba's rule ends shadow rays short of the light, which settles the tie in native as well.
    settled = native(scene, offset="mitsuba")
    assert np.abs(double.render(scene, RenderOptions()).image - settled).max() <= 1e-11


@pytest.mark.parametrize("count", [0, 1, 3])
def test_the_first_delivery_is_stock(
    count: int, make_scene: Build, single: Renderer, native: Native
) -> None:
    """Without light no plugin of ours is loaded, and the colours are exact doubles."""
    things = [
        sphere([200, 51, 50], [0, 0, 0], 1), plane([100, 100, 200], [0, 0, -1], [0.1, 0, 2]),
        sphere([5, 200, 50], [1.5, 1, 0.2], 0.8),
    ][:count]  # fmt: skip
    scene = make_scene(delivery=1, objects=things)
    rendering = single.render(scene, RenderOptions())
    assert (rendering.settings["integrator"], rendering.settings["camera"]) == (
        "aov",
        "perspective",
    )
    assert np.array_equal(rendering.image, native(scene))


def test_a_picture_too_wide_for_stock_cameras_is_rendered_by_ours(
    make_scene: Build, single: Renderer, native: Native
) -> None:
    """Mitsuba's perspective fails near 180 degrees; then the lane's own camera takes over."""
    things = [sphere([200, 51, 50], [0, 0, 0], 1), plane([100, 100, 200], [0, 0, -1], [0, 0, 2])]
    scene = make_scene(delivery=1, objects=things, screen_distance=1e-4)
    image = single.render(scene, RenderOptions()).image
    assert np.abs(image - native(scene, offset="mitsuba")).max() <= 1e-6


def test_depth_without_branching_is_unlimited(
    make_scene: Build, double: Renderer, native: Native
) -> None:
    """A million bounces are no obstacle where a hit spawns one ray at most."""
    scene = make_scene(objects=[MIRROR, *PLANES], lights=LIGHTS, max_depth=10**6)
    image = double.render(scene, RenderOptions()).image
    assert np.abs(image - native(scene)).max() <= 1e-11


def test_a_ray_parallel_to_a_plane_ahead_of_it_misses(double: Renderer) -> None:
    """The middle row looks along floor and ceiling at the sky between them.

    It once took the ceiling, at an infinite distance, for a tie with nothing hit yet.
    """
    scene = Scene.build(
        delivery=2, v_res=3, h_res=5, pixel_size=0.1, screen_distance=1.0,
        eye=[0, -6, 1], target=[0, 0, 1], up=[0, 0, 1], background=[120, 170, 230],
        objects=[plane([200, 200, 190], [0, 0, 0], [0, 0, 1], ka=0.2, eta=1),
                 plane([90, 90, 90], [0, 0, 4], [0, 0, 1], ka=0.1, eta=1)],
    )  # fmt: skip
    middle = double.render(scene, RenderOptions()).image[1]
    assert np.abs(middle - np.array([120, 170, 230]) / 255).max() <= 1e-15
