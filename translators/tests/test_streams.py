"""The native tracer's vector streams: on every instruction set the bits of the scalar recursion."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace
from importlib.resources import files
from pathlib import Path

import numpy as np
import pytest

from crosstrace.native import _core
from crosstrace.translators.course import load, parse
from crosstrace.translators.scene import Scene, sphere

Generator = Callable[..., Scene]
SCENES = sorted(
    Path(str(path))
    for folder in ("course", "hard")
    for path in files("crosstrace.scenes").joinpath(folder).iterdir()
    if path.name.endswith(".txt")
)
VECTORS = [name for name in _core.instructions() if name != "scalar"]
#: What the streams know beside the defaults, and a few readings that they leave to the recursion.
READINGS = (
    {"epsilon": "1e-3", "shadow_min": "2e-3", "light_min": "0.5", "far": "9"},
    {"epsilon_twice": "yes", "exhausted": "background", "miss": "black"},
    {"refraction": "inverted", "depth": "plus-one", "index": "float32"},
    {"refraction": "one-way", "depth": "minus-one", "shadow_min": "0.25"},
    {"mix": "convex", "tir": "add", "offset": "normal", "nesting": "tracked"},
)


def _outputs(scene: Scene, rows: int) -> dict[str, np.ndarray]:
    pixels = (rows, scene.h_res)
    return {
        "image": np.full((*pixels, 3), -7.0),
        "image_low": np.full((*pixels, 3), -7.0),
        "object": np.full(pixels, -7, np.int32),
        "t": np.full(pixels, -7.0),
        "normal": np.full((*pixels, 3), -7.0),
        "tree": np.zeros(pixels, np.uint64),
        "rays": np.zeros(pixels, np.uint32),
        "contributions": np.full((*pixels, 6, 3), -7.0),
    }


def _render(scene: Scene, settings: dict[str, str]) -> tuple[dict[str, np.ndarray], dict[str, int]]:
    begin, end = int(settings.get("row_begin", 0)), int(settings.get("row_end", scene.v_res))
    outputs = _outputs(scene, end - begin)
    counts = _core.render(scene.native_view(), list(settings.items()), outputs, None)
    return outputs, {name: n for name, n in counts.items() if name != "threads"}


def _differing(scene: Scene, settings: dict[str, str], vectors: Iterable[str]) -> list[str]:
    """Name the outputs and counts whose bits are not the recursion's."""
    wrong = []
    expected, expected_counts = _render(scene, settings | {"instructions": "scalar"})
    for most in vectors:
        found, counts = _render(scene, settings | {"instructions": most})
        wrong += [
            f"{most}: {name}"
            for name in expected
            if found[name].tobytes() != expected[name].tobytes()
        ]
        wrong += [f"{most}: counts"] if counts != expected_counts else []
    return wrong


@pytest.mark.parametrize("precision", ["f64", "f32"])
@pytest.mark.parametrize("path", SCENES, ids=lambda path: path.stem)
def test_packaged_scenes_have_the_same_bits(path: Path, precision: str) -> None:
    """Of course and hard scenes no value of any output differs, at a resolution of odd numbers."""
    scene = load(path)
    settings = {"precision": precision, "threads": "2"}
    assert _differing(scene.resized(45, 61), settings, VECTORS) == []
    near = settings | {"light_min": "0.5", "shadow_min": "0.01", "tolerance": "0.02"}
    assert _differing(scene.resized(45, 61), near, VECTORS) == []


@pytest.mark.parametrize("precision", ["f64", "f32"])
@pytest.mark.parametrize("delivery", [1, 2, 3])
@pytest.mark.parametrize("seed", range(12))
def test_random_scenes_have_the_same_bits(
    random_scene: Generator, seed: int, delivery: int, precision: str
) -> None:
    """Neither effect masks, nor readings, nor bands of rows, nor threads make a difference."""
    scene = random_scene(seed, delivery)
    rng = np.random.default_rng(seed)
    settings = {"precision": precision, "threads": str(1 + seed % 3)}
    assert _differing(scene, settings, VECTORS) == []
    pruned = settings | {"tolerance": str(10.0 ** rng.uniform(-6, -0.5))}
    assert _differing(scene, pruned, VECTORS) == []
    masked = settings | {"effects": str(rng.integers(256)), "row_begin": "5", "row_end": "12"}
    assert _differing(scene, masked, VECTORS) == []
    assert _differing(scene, settings | READINGS[seed % len(READINGS)], VECTORS) == []


@pytest.mark.parametrize("precision", ["f64", "f32"])
@pytest.mark.parametrize("n", [63, 64, 65, 300])
def test_crowds_have_the_same_bits(random_scene: Generator, n: int, precision: str) -> None:
    """Spheres that touch, overlap, repeat each other and hide lamps; more than a word has bits."""
    rng = np.random.default_rng(n)
    base = random_scene(n)
    grid = np.round(rng.uniform(-4, 4, (n, 3)) * 2) / 2
    crowd = [
        sphere(rng.integers(0, 256, 3), at, float(rng.choice([0.25, 0.5, 0.4])), ka=0.1, kd=0.6,
               ks=0.3, eta=float(rng.choice([3, 20.5, 900, 1024, 2000])),
               kr=float(rng.choice([0, 0.5])),
               kt=float(rng.choice([0, 0, 0.7])), n=1.4)
        for at in grid
    ]  # fmt: skip
    lights = [((90, 80, 70), tuple(at)) for at in rng.uniform(-5, 5, (40 if n == 65 else 3, 3))]
    scene = Scene.build(
        delivery=3, v_res=24, h_res=32, pixel_size=0.04, screen_distance=0.9, eye=base.eye,
        target=(0, 0, 0), up=(0.1, 0.2, 1.3), background=(9, 90, 200), max_depth=3, objects=crowd,
        lights=lights, ambient=(255, 255, 255),
    )  # fmt: skip
    assert _differing(scene, {"precision": precision}, VECTORS) == []


@pytest.mark.parametrize("precision", ["f64", "f32"])
@pytest.mark.parametrize("scale", ["1e-30", "1e-12", "1e-3", "1e6", "1e15", "1e60"])
def test_scenes_of_any_size_have_the_same_bits(
    random_scene: Generator, scale: str, precision: str
) -> None:
    """Where squares under- or overflow the stream goes wrong as the recursion does."""
    scene = random_scene(3)
    factor = float(scale)
    geometry, lights = scene.geometry.copy(), scene.lights.copy()
    geometry[:, :3] *= factor
    geometry[scene.is_sphere, 3] *= factor
    lights[:, 3:] *= factor
    grown = replace(
        scene, eye=scene.eye * factor, target=scene.target * factor, geometry=geometry,
        lights=lights, pixel_size=scene.pixel_size * factor,
        screen_distance=scene.screen_distance * factor, checked=False,
    )  # fmt: skip
    assert _differing(grown, {"precision": precision}, VECTORS) == []


@pytest.mark.parametrize("precision", ["f64", "f32"])
def test_trees_deeper_than_a_stream_have_the_same_bits(precision: str) -> None:
    """Two mirrors at depth 150: below some level rays go on one by one, and nothing shows it."""
    wall = "99 99 99 0.1 0.3 0 1 0.97 0 1"
    ball = "99 0 0 .1 .3 .5 9 .4 .5 1.5 * 0.3 2 0 0.5"
    scene = parse(
        f"9 21 0.1 1 0.2 0 0 0 3 0.1 0 0 1 9 50 90 150 3 {wall} / 0 5 0 0 -1 0.02 "
        f"{wall} / 0 -5 0 0.03 1 0 {ball} 9 9 9 1 200 200 200 1 1 1"
    )
    assert _differing(scene, {"precision": precision, "threads": "2"}, VECTORS) == []
    assert _differing(scene, {"precision": precision, "tolerance": "1e-3"}, VECTORS) == []
    rays = _render(scene, {"precision": precision})[0]["rays"]
    assert rays.max() > 200


@pytest.mark.slow
@pytest.mark.parametrize("precision", ["f64", "f32"])
@pytest.mark.parametrize("path", SCENES, ids=lambda path: path.stem)
def test_packaged_scenes_have_the_same_bits_at_full_size(path: Path, precision: str) -> None:
    """As above, at the resolution of the file."""
    assert _differing(load(path), {"precision": precision, "threads": "2"}, VECTORS) == []


@pytest.mark.slow
@pytest.mark.parametrize("precision", ["f64", "f32"])
@pytest.mark.parametrize("seed", range(100, 600))
def test_many_random_scenes_have_the_same_bits(
    random_scene: Generator, seed: int, precision: str
) -> None:
    """As above, for more scenes and for the readings that the streams know."""
    scene = random_scene(seed, 3)
    settings = {"precision": precision, **READINGS[seed % 4]}
    assert _differing(scene, settings, VECTORS) == []
