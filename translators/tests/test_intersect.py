"""Nearest hits of given rays: the bits of the scalar kernel, and what the measurements count."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from crosstrace.native import _core
from crosstrace.translators.native.intersect import (
    instruction_sets,
    nearest,
    operations,
    peak_flops,
)
from crosstrace.translators.registry import renderer
from crosstrace.translators.renderer import RenderOptions
from crosstrace.translators.scene import Scene, plane, sphere

Generator = Callable[..., Scene]


def _rays(scene: Scene, n: int, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Return rays from around the eye in all directions, (3, n) each."""
    rng = np.random.default_rng(seed)
    ways = rng.normal(size=(3, n))
    origins = scene.eye[:, None] + rng.uniform(-1, 1, (3, n))
    return origins, np.ascontiguousarray(ways / np.linalg.norm(ways, axis=0))


@pytest.mark.parametrize("n", [0, 1, 7, 8, 255, 256, 1000])
@pytest.mark.parametrize("seed", range(5))
def test_every_instruction_set_finds_the_same_bits(
    random_scene: Generator, seed: int, n: int
) -> None:
    """Distances and objects are the scalar kernel's, whatever is left over of whole vectors."""
    scene = random_scene(seed)
    origins, ways = _rays(scene, n, seed)
    t, hit, _ = nearest(scene, origins, ways, instructions="scalar")
    assert np.isinf(t[hit < 0]).all() and np.isfinite(t[hit >= 0]).all()
    for most in instruction_sets():
        for search in ("scan", "tree", "auto"):
            found = nearest(scene, origins, ways, 1, most, search)
            assert found[0].tobytes() == t.tobytes()
            assert found[1].tobytes() == hit.tobytes()


def test_many_spheres_are_found_through_their_tree() -> None:
    """A crowd gives the same hits by its tree and by asking all, in narrow and in wide blocks."""
    rng = np.random.default_rng(1)
    scene = Scene.build(
        delivery=1, v_res=2, h_res=2, pixel_size=0.1, screen_distance=1, eye=(0, -9, 0),
        target=(0, 0, 0), up=(0, 0, 1), background=(0, 0, 0),
        objects=[sphere((9, 9, 9), at, 0.2) for at in rng.uniform(-4, 4, (400, 3))],
    )  # fmt: skip
    origins, ways = _rays(scene, 1000, 2)
    narrow = np.array([[0.0], [1.0], [0.0]]) + 0.2 * ways
    for directions in (ways, np.ascontiguousarray(narrow / np.linalg.norm(narrow, axis=0))):
        t, hit, _ = nearest(scene, origins, directions, instructions="scalar", search="scan")
        assert (hit >= 0).any()
        found = nearest(scene, origins, directions)
        assert np.array_equal(found[0], t) and np.array_equal(found[1], hit)


@pytest.mark.parametrize("n_spheres", [7, 8, 40, 62])
@pytest.mark.parametrize("n", [1, 255, 256, 1000])
def test_objects_that_a_narrow_block_passes_by_are_left_out_without_a_trace(
    n_spheres: int, n: int
) -> None:
    """Too few for a tree: rays that keep together meet what the scalar kernel says, planes too."""
    rng = np.random.default_rng(n_spheres)
    scene = Scene.build(
        delivery=1, v_res=2, h_res=2, pixel_size=0.1, screen_distance=1, eye=(0, -9, 0),
        target=(0, 0, 0), up=(0, 0, 1), background=(0, 0, 0),
        objects=[
            plane((9, 9, 9), (0, 0, -4), (0, 0, 1)), plane((9, 9, 9), (0, 30, 0), (0, -1, 0.2)),
            *(sphere((9, 9, 9), at, 0.6) for at in rng.uniform(-4, 4, (n_spheres, 3))),
        ],
    )  # fmt: skip
    origins, ways = _rays(scene, n, n_spheres)
    towards = rng.normal(size=(3, 1)) * [[0.3], [0], [0.3]] + [[0.0], [1.0], [0.0]]
    narrow = towards + 0.1 * ways
    narrow = np.ascontiguousarray(narrow / np.linalg.norm(narrow, axis=0))
    t, hit, _ = nearest(scene, origins, narrow, instructions="scalar", search="scan")
    assert n == 1 or (hit >= 0).any()
    for most in instruction_sets():
        found = nearest(scene, origins, narrow, instructions=most)
        assert found[0].tobytes() == t.tobytes() and found[1].tobytes() == hit.tobytes()


def test_a_tree_that_was_built_before_is_what_is_asked() -> None:
    """Spheres that have moved since then are not found where they are now: the tree was used."""
    scene = Scene.build(
        delivery=1, v_res=2, h_res=2, pixel_size=0.1, screen_distance=1, eye=(0, -9, 0),
        target=(0, 0, 0), up=(0, 0, 1), background=(0, 0, 0),
        objects=[sphere((9, 9, 9), (x, 0, 0), 0.2) for x in np.linspace(-4, 4, 400)],
    )  # fmt: skip
    scene.geometry.setflags(write=True)
    tree = _core.tree(scene.native_view(), None)
    scene.geometry[:, 2] += 100
    origins = np.tile(scene.eye[:, None] + np.array([[0.0], [0.0], [100.0]]), 16)
    ways = np.tile([[0.0], [1.0], [0.0]], 16)
    assert (nearest(scene, origins, ways)[1] >= 0).all()
    assert (nearest(scene, origins, ways, tree=tree)[1] < 0).all()


def test_primary_rays_hit_what_the_picture_shows(random_scene: Generator) -> None:
    """Through the pixels' centres the hits are those of the rendered picture."""
    scene = random_scene(1)
    layers = renderer("native").render(scene, RenderOptions(layers=True)).layers
    seen = layers["object"].ravel() >= 0
    u_v = np.indices(scene.shape[:2]).reshape(2, -1)[:, seen] + 0.5
    w = scene.eye - scene.target
    w /= np.linalg.norm(w)
    u = np.cross(scene.up, w)
    u /= np.linalg.norm(u)
    x = scene.pixel_size * (u_v[1] - scene.h_res / 2)
    y = -scene.pixel_size * (u_v[0] - scene.v_res / 2)
    ways = x * u[:, None] + y * np.cross(w, u)[:, None] - scene.screen_distance * w[:, None]
    ways /= np.linalg.norm(ways, axis=0)
    origins = np.ascontiguousarray(np.broadcast_to(scene.eye[:, None], ways.shape))
    t, hit, _ = nearest(scene, origins, np.ascontiguousarray(ways))
    assert (hit == layers["object"].ravel()[seen]).mean() > 0.99
    same = hit == layers["object"].ravel()[seen]
    assert np.allclose(t[same], layers["t"].ravel()[seen][same], rtol=1e-9)


def test_arrays_of_another_size_are_refused(random_scene: Generator) -> None:
    """Neither too few origins nor outputs that are too small are written or read past their end."""
    scene = random_scene(0)
    origins, ways = _rays(scene, 8, 0)
    outputs = {"t": np.zeros(8), "object": np.zeros(8, np.int64)}
    with pytest.raises(ValueError, match="origin: expected 27 items"):
        _core.intersect(scene.native_view(), [], 9, origins, ways, 1, outputs)
    with pytest.raises(ValueError, match="t: expected 8 items"):
        _core.intersect(scene.native_view(), [], 8, origins, ways, 1, {"t": np.zeros(7)})
    with pytest.raises(ValueError, match="at least one pass"):
        _core.intersect(scene.native_view(), [], 8, origins, ways, 0, outputs)
    with pytest.raises(RuntimeError):
        _core.intersect(
            scene.native_view(), [("precision", "f32")], 8, origins, ways, 1, outputs
        )  # fmt: skip


def test_operations_are_counted_ray_by_ray() -> None:
    """A ray that hits a ball takes 29, one beside it 26, one away from it 14; a plane 14 or 13."""
    camera: dict[str, Any] = {
        "delivery": 1, "v_res": 1, "h_res": 1, "pixel_size": 1, "screen_distance": 1,
        "eye": (0, 0, 0), "target": (0, 1, 0), "up": (0, 0, 1), "background": (0, 0, 0),
    }  # fmt: skip
    ball = Scene.build(objects=[sphere((9, 9, 9), (0, 5, 0), 1)], **camera)
    floor = Scene.build(objects=[plane((9, 9, 9), (0, 0, -1), (0, 0, 2))], **camera)
    down = np.array([[0.0, 0.6, -0.8]]).T
    at, away = np.array([[0.0, 1.0, 0.0]]).T, np.array([[0.0, -1.0, 0.0]]).T
    start = np.zeros((3, 1))
    assert [operations(ball, start, way) for way in (at, down, away)] == [29, 26, 14]
    assert [operations(floor, start, way) for way in (down, -down)] == [14, 13]


def test_the_peak_is_a_speed() -> None:
    """Every instruction set of vectors has one, the scalar kernel has none."""
    assert instruction_sets()
    assert all(peak_flops(name, 0.005) > 0 for name in instruction_sets())
    assert peak_flops("scalar", 0.005) == 0
    with pytest.raises(ValueError, match="instructions: expected"):
        peak_flops("mmx", 0.005)
