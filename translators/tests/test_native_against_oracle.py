"""The native tracer against the oracle, which shares no code with it: small random scenes.

They agree to 1e-12 of the larger of 1 and the value, except at pixels that an edge crosses: there
the oracle's smallest margin is below 1e-6, so that either may decide otherwise or a rounding error
is magnified under a square root. How few those pixels are is asserted too. The oracle
computes in 80 bits, so that what is measured is the native tracer's error.
"""

from __future__ import annotations

from collections.abc import Callable
from types import ModuleType

import numpy as np
import pytest

from crosstrace.native import _core
from crosstrace.translators.registry import renderer
from crosstrace.translators.renderer import RenderOptions
from crosstrace.translators.scene import KT, Scene

Generator = Callable[..., Scene]

TOLERANCE = 1e-12
EDGE = 1e-6


def compare(oracle: ModuleType, scenes: list[Scene], **readings: str) -> tuple[float, float]:
    """Return (largest relative difference off the edges, share of pixels on edges)."""
    worst, on_edge = 0.0, []
    for scene in scenes:
        native = renderer("native").render(scene, RenderOptions(threads=1, readings=readings)).image
        slow = oracle.render(oracle.plain(scene), "extended", **readings)
        error = np.abs(native - slow.image) / np.maximum(1, np.abs(slow.image))
        edge = slow.margin < EDGE
        worst = max(worst, float(error[~edge].max(initial=0)))
        on_edge.append(edge.mean())
    return worst, float(np.mean(on_edge))


@pytest.mark.parametrize("delivery", [1, 2, 3])
def test_random_scenes_look_the_same(
    oracle: ModuleType, random_scene: Generator, delivery: int
) -> None:
    """Forty scenes of each delivery: spheres, planes, lights, mirrors, glass, depth 0 to 5."""
    scenes = [random_scene(seed, delivery) for seed in range(40)]
    worst, on_edge = compare(oracle, scenes)
    assert worst <= TOLERANCE
    assert on_edge < 0.005


READINGS = [
    ("mix", "convex"), ("plane_normal", "raw"), ("lighting_normal", "facing"), ("view", "eye"),
    ("specular_gate", "lit"), ("glass_shadow", "clear"), ("shadow_distance", "ignored"),
    ("offset", "normal"), ("offset", "mitsuba"), ("epsilon_twice", "yes"), ("epsilon", "1e-3"),
    ("depth", "minus-one"), ("depth", "plus-one"), ("exhausted", "background"), ("miss", "black"),
    ("refraction", "inverted"), ("refraction", "one-way"), ("nesting", "tracked"),
    ("nesting", "interiors"), ("index", "float32"),
    ("tir", "ignore"), ("tir", "add"), ("tir", "plus-one"), ("tir", "needs-kr"), ("tir", "always"),
    ("inner_reflection", "off"), ("recursion", "clamp"), ("recursion", "scale"),
    ("shadow_min", "0.5"), ("light_min", "2"), ("far", "7"),
]  # fmt: skip


@pytest.mark.parametrize(("name", "value"), READINGS, ids=lambda text: text)
def test_a_reading_means_the_same_to_both(
    oracle: ModuleType, random_scene: Generator, name: str, value: str
) -> None:
    """Ten scenes under each reading; and the reading does change what the oracle draws."""
    scenes = [random_scene(seed, max_depth=2 + seed % 3) for seed in range(10)]
    worst, on_edge = compare(oracle, scenes, **{name: value})
    assert worst <= TOLERANCE
    assert on_edge < 0.005
    numbers = [oracle.plain(scene) for scene in scenes]
    changed = [oracle.render(x, **{name: value}).image - oracle.render(x).image for x in numbers]
    # How far rays start from the surface shows at edges alone, which these few pixels can miss.
    if name == "index":
        assert max(np.abs(change).max() for change in changed) > 1e-9  # a float's share of n
    elif name not in ("offset", "epsilon", "epsilon_twice"):
        assert max(np.abs(change).max() for change in changed) > 1e-3


def test_every_reading_of_the_native_tracer_is_compared() -> None:
    """The list above, `offset=bound` and `epsilon_for=shadow` below make up the native table."""
    compared = {*READINGS, ("offset", "bound"), ("epsilon_for", "shadow")}
    for name, default, choices in _core.readings():
        values = {value for other, value in compared if other == name}
        if choices == "NUMBER":
            assert values, name
        else:
            assert values == set(choices.split("|")) - {default}, name


def test_a_bound_of_the_rounding_is_an_offset_like_any_other(
    oracle: ModuleType, random_scene: Generator
) -> None:
    """Colours depend on the offset at edges alone, so `bound` equals a tiny step along the ray."""
    for seed in range(10):
        scene = random_scene(seed)
        options = RenderOptions(threads=1, readings={"offset": "bound"})
        slow = oracle.render(oracle.plain(scene), "extended", epsilon=1e-9)
        coarse = oracle.render(oracle.plain(scene), "extended", epsilon=1e-7)
        # A step of 1e-7 may not change a pixel, or an edge is near.
        steady = np.abs(slow.image - coarse.image).max(axis=-1) < TOLERANCE
        error = np.abs(renderer("native").render(scene, options).image - slow.image)
        assert error[steady].max() <= 10 * TOLERANCE
        assert steady.mean() > 0.99


def test_without_an_offset_of_secondary_rays_primary_light_is_unchanged(
    oracle: ModuleType, random_scene: Generator
) -> None:
    """Where no pixel's tree sends a secondary ray, `epsilon_for=shadow` changes nothing.

    Elsewhere a ray starts on its surface to the last bit, so that rounding decides; the oracle
    calls every such pixel an edge.
    """
    scenes = [random_scene(seed, max_depth=2) for seed in range(10)]
    worst, on_edge = compare(oracle, scenes, epsilon_for="shadow")
    assert worst <= TOLERANCE
    assert on_edge < 0.7


def test_the_random_scenes_hold_what_they_are_meant_to_test(
    oracle: ModuleType, random_scene: Generator
) -> None:
    """Glass, total reflection, shadows and every depth occur, and glass is seen, not only there."""
    scenes = [random_scene(seed) for seed in range(40)]
    assert {scene.max_depth for scene in scenes} == set(range(6))
    assert sum((scene.material[:, KT] > 0).any() for scene in scenes) > 20
    changes = dict.fromkeys(("tir", "glass_shadow", "inner_reflection"), 0)
    for scene in scenes:
        numbers = oracle.plain(scene)
        for name, value in (("tir", "ignore"), ("glass_shadow", "clear"),
                            ("inner_reflection", "off")):  # fmt: skip
            change = oracle.render(numbers, **{name: value}).image - oracle.render(numbers).image
            changes[name] += bool(np.abs(change).max() > 1e-3)
    assert min(changes.values()) >= 5
