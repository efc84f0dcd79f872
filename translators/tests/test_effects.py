"""Which effects a scene calls for."""

from __future__ import annotations

import numpy as np
import pytest

from crosstrace.translators.course import parse
from crosstrace.translators.effects import EFFECTS, effects, names
from crosstrace.translators.registry import renderer
from crosstrace.translators.renderer import RenderOptions
from crosstrace.translators.scene import Scene

CAMERA = "24 32 0.05 1 0 -6 1.5 0 0 0.8 0 0 1 120 170 230 "


def _scene(material: str, depth: int = 3, light: str = "200 200 200", n: str = "1.5") -> Scene:
    return parse(
        f"{CAMERA}{depth} 2 200 100 50 {material} {n} * 0 0 1 1 "
        f"90 90 90 0.1 0.5 0 1 0 0 1 / 0 0 0 0 0 1 255 255 255 1 {light} -4 -5 6"
    )


@pytest.mark.parametrize(
    ("material", "expected"),
    [
        ("0 0 0 1 0 0", set()),
        ("0.1 0 0 1 0 0", {"ambient"}),
        ("0 0.1 0 1 0 0", {"diffuse", "shadows"}),
        ("0 0 0.1 1 0 0", {"specular", "shadows"}),
        ("0 0 0 1 0.1 0", {"reflection"}),
        ("0 0 0 1 0 0.1", {"refraction", "total_reflection"}),
    ],
)
def test_each_coefficient_calls_for_its_own_effects(material: str, expected: set[str]) -> None:
    """A coefficient of 0 calls for nothing."""
    assert set(names(int(effects(_scene(material)).objects[0]))) == expected


def test_depth_zero_calls_for_no_secondary_ray() -> None:
    """With max_depth 0 mirrors and glass show only their own light."""
    called_for = effects(_scene("0 0 0 1 1 1", depth=0))
    assert not {"reflection", "refraction", "total_reflection"} & set(called_for.names)


def test_a_black_light_calls_for_nothing() -> None:
    """Light of colour 0 0 0 needs neither a shadow ray nor a highlight."""
    assert effects(_scene("0.2 1 1 9 0 0", light="0 0 0")).names == ("ambient",)


def test_index_one_never_reflects_totally() -> None:
    """n = 1 bends nothing."""
    assert "total_reflection" not in effects(_scene("0 0 0 1 0 1", n="1")).names


def test_a_scene_of_delivery_one_is_flat() -> None:
    """Delivery 1 knows no other effect, and an empty one none at all."""
    assert effects(parse(CAMERA + "1 255 0 0 * 0 0 1 1")).names == ("flat",)
    assert effects(parse(CAMERA + "0")).names == ()


@pytest.mark.parametrize("reading", [{}, {"tir": "always"}, {"exhausted": "background"},
                                     {"depth": "plus-one"}, {"mix": "convex"}])  # fmt: skip
@pytest.mark.parametrize(
    "material", ["0.1 0.5 0 1 0 0", "0 0 0.5 20 0.5 0", "0 0.2 0 1 0 0.8", "0.1 0.2 0.3 4 0.3 0.6"]
)
@pytest.mark.parametrize("depth", [0, 1, 4])
def test_leaving_out_what_is_not_called_for_changes_no_bit(
    material: str, depth: int, reading: dict[str, str]
) -> None:
    """The native image with the scene's own effects is that with all effects, bit for bit."""
    scene = _scene(material, depth)
    native = renderer("native")
    gated = native.render(scene, RenderOptions(readings=reading)).image
    full = RenderOptions(readings=reading, effects=frozenset(EFFECTS))
    assert np.array_equal(gated, native.render(scene, full).image)
