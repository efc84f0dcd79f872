"""Fixtures of the Mitsuba tests: small scenes and the lanes."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from official_scenes import official  # noqa: F401, pytest finds the fixture here

from crosstrace.translators.mitsuba.probe import probe
from crosstrace.translators.registry import renderer
from crosstrace.translators.renderer import Renderer, RenderOptions
from crosstrace.translators.scene import Scene

Image = NDArray[np.float64]


@pytest.fixture(scope="session")
def works() -> None:
    """Skip the test where Mitsuba does not work, with the reason that the probe gives."""
    found = probe()
    if not found.available:
        pytest.skip(f"Mitsuba does not work here: {found.reason}")


@pytest.fixture
def single(works: None) -> Renderer:
    """The float32 lane."""
    return renderer("mitsuba")


@pytest.fixture
def double(works: None) -> Renderer:
    """The float64 lane."""
    return renderer("mitsuba-f64")


@pytest.fixture(params=["mitsuba", "mitsuba-f64"])
def lane(request: pytest.FixtureRequest, works: None) -> Renderer:
    """Each of the two lanes in turn."""
    return renderer(request.param)


@pytest.fixture
def native() -> Callable[..., Image]:
    """Render with the native tracer, under readings where any are given."""

    def image(scene: Scene, **readings: str) -> Image:
        return renderer("native").render(scene, RenderOptions(readings=readings)).image

    return image


@pytest.fixture
def make_scene() -> Callable[..., Scene]:
    """Build a delivery-3 scene of 60×80 pixels; any field may be given."""

    def build(**fields: Any) -> Scene:
        camera: dict[str, Any] = {
            "delivery": 3, "v_res": 60, "h_res": 80, "pixel_size": 0.02, "screen_distance": 1.0,
            "eye": [0.0, -6.0, 1.0], "target": [0.0, 0.0, 0.0], "up": [0.1, 0.0, 1.0],
            "background": [30.0, 60.0, 90.0],
        }  # fmt: skip
        if fields.get("delivery", 3) > 1:
            camera["ambient"] = [255.0, 200.0, 255.0]
        return Scene.build(**{**camera, **fields})

    return build
