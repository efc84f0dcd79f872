"""The tree of boxes over many spheres: everywhere the bits of asking every object."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from crosstrace.native import _core
from crosstrace.translators.course import load
from crosstrace.translators.scene import Scene

SCENES = sorted(
    Path(str(path))
    for folder in ("course", "hard")
    for path in files("crosstrace.scenes").joinpath(folder).iterdir()
    if path.name.endswith(".txt")
)
ROWS, COLUMNS = 33, 44
FAST = ("f32", "f64", "f64c", "f80")


def cloud(n: int, seed: int = 3) -> Scene:
    """Return n spheres in a cube, some of them twice, mirrors and glass, on a floor."""
    rng = np.random.default_rng(seed)
    geometry = np.zeros((n, 6))
    geometry[:, :3] = rng.uniform(-10, 10, (n, 3))
    geometry[:, 3] = rng.uniform(0.2, 1, n) * 6 / np.cbrt(n)
    geometry[n // 2 : n // 2 + n // 20] = geometry[: n // 20]
    geometry[0] = [0, 0, -12, 0, 0, 1]
    material = np.tile([0.2, 0.6, 0.3, 20.0, 0.0, 0.0, 1.5], (n, 1))
    material[rng.random(n) < 0.3, 4] = 0.4
    material[rng.random(n) < 0.2, 5] = 0.6
    kind = np.zeros(n, np.uint8)
    kind[0] = 1
    return Scene(
        delivery=3, v_res=ROWS, h_res=COLUMNS, pixel_size=0.03, screen_distance=1.5,
        eye=np.array([0.0, -26, 3]), target=np.zeros(3), up=np.array([0.0, 0, 1]),
        background=np.array([90.0, 120, 200]), max_depth=3, kind=kind,
        color=rng.integers(0, 256, (n, 3)).astype(float), material=material, geometry=geometry,
        lights=np.array([[200.0, 200, 200, -30, -40, 50], [90, 90, 90, 0, 0, 0]]),
    )  # fmt: skip


def _by(way: str, run: Callable[[list[tuple[str, str]]], Any], **settings: str) -> Any:
    return run([*settings.items(), ("search", way), ("threads", "2")])


def _image(scene: Scene, settings: list[tuple[str, str]]) -> dict[str, np.ndarray]:
    shape = (scene.v_res, scene.h_res)
    outputs: dict[str, np.ndarray] = {
        "image": np.empty((*shape, 3)), "image_low": np.empty((*shape, 3)),
        "object": np.empty(shape, np.int32), "t": np.empty(shape),
        "tree": np.empty(shape, np.uint64), "rays": np.empty(shape, np.uint32),
        "contributions": np.empty((*shape, 6, 3)),
    }  # fmt: skip
    _core.render(scene.native_view(), settings, outputs, None)
    return outputs


def _certified(scene: Scene, settings: list[tuple[str, str]]) -> dict[str, np.ndarray]:
    n = scene.v_res * scene.h_res
    outputs: dict[str, np.ndarray] = {
        "lo": np.empty((n, 3)), "hi": np.empty((n, 3)), "pixel_class": np.empty(n, np.uint8),
        "level": np.empty(n, np.uint8), "decision": np.empty(n, np.uint8),
    }  # fmt: skip
    _core.certify(scene.native_view(), settings, None, 1e-9, 0.0, outputs, None)
    return outputs


def _differing(scene: Scene, run: Callable[..., dict[str, np.ndarray]], **how: str) -> list[str]:
    """Name the outputs of which the tree gives other bits than the scan."""
    scan, tree = (_by(way, lambda s: run(scene, s), **how) for way in ("scan", "tree"))
    return [name for name in scan if scan[name].tobytes() != tree[name].tobytes()]


@pytest.mark.parametrize("path", SCENES, ids=lambda path: path.stem)
def test_packaged_scenes_have_the_same_bits(path: Path) -> None:
    """Course and hard scenes, of few objects: the tree is forced on them."""
    scene = load(path).resized(ROWS, COLUMNS)
    for precision, most in itertools.product(FAST, ("scalar", "native")):
        assert _differing(scene, _image, precision=precision, instructions=most) == []


@pytest.mark.slow
@pytest.mark.parametrize("path", SCENES, ids=lambda path: path.stem)
def test_packaged_scenes_have_the_same_bits_in_wide_precisions(path: Path) -> None:
    """Double-double and float128."""
    scene = load(path).resized(17, 23)
    for precision in ("dd", "f128"):
        assert _differing(scene, _image, precision=precision) == []


@pytest.mark.parametrize("path", SCENES, ids=lambda path: path.stem)
def test_packaged_scenes_have_the_same_enclosures(path: Path) -> None:
    """Bounds, classes, and the type that closed the pixel."""
    scene = load(path).resized(17, 23)
    assert _differing(scene, _certified) == []


@pytest.mark.parametrize("most", _core.instructions())
def test_a_cloud_of_spheres_has_the_same_bits_and_enclosures(most: str) -> None:
    """With spheres that tie, so many that bundles list some and walk for others."""
    scene = cloud(3000)
    for precision in ("f32", "f64"):
        assert _differing(scene, _image, precision=precision, instructions=most) == []
    assert _differing(scene.resized(12, 16), _certified, instructions=most) == []


def test_rays_moved_by_errors_meet_the_same_spheres() -> None:
    """The samples of the perturbed kernel, whose directions are not of length 1."""
    scene = cloud(500)

    def samples(scene: Scene, settings: list[tuple[str, str]]) -> dict[str, np.ndarray]:
        n = scene.v_res * scene.h_res
        outputs: dict[str, np.ndarray] = {
            "colors": np.empty((n, 2, 3)),
            "trees": np.empty((n, 2), np.uint64),
        }
        _core.perturb(scene.native_view(), settings, None, 2, 1e-6, 7, outputs, None)
        return outputs

    assert _differing(scene, samples) == []


def test_a_tree_that_was_built_before_gives_the_same_bits() -> None:
    """In bands, as it renders large images; a tree of other arrays is not used."""
    scene = cloud(2000)
    whole = _image(scene, [])["image"]
    for tree in (_core.tree(s.native_view(), None) for s in (scene, cloud(100))):
        for begin, end in ((0, 10), (10, ROWS)):
            band = {"image": np.empty((end - begin, COLUMNS, 3))}
            rows = [("row_begin", str(begin)), ("row_end", str(end))]
            _core.render(scene.native_view(), rows, band, None, tree)
            assert np.array_equal(band["image"], whole[begin:end])


def test_sorting_many_spheres_can_be_stopped() -> None:
    """Before the first ray is traced: by the exception of the callback, which gets through."""
    scene = cloud(300_000)

    class EnoughError(Exception):
        pass

    def stop(_: float) -> None:
        raise EnoughError

    outputs = {"image": np.empty((ROWS, COLUMNS, 3))}
    for run in (lambda: _core.tree(scene.native_view(), stop),
                lambda: _core.render(scene.native_view(), [], outputs, stop)):  # fmt: skip
        with pytest.raises(EnoughError):
            run()


@pytest.mark.slow
def test_a_million_spheres_render() -> None:
    """Every ray that the scan can be asked about in reasonable time meets the same sphere."""
    scene = cloud(10**6)
    all_of_it = _image(scene, [("search", "tree")])
    rows = [("row_begin", "16"), ("row_end", "17"), ("search", "scan"), ("precision", "f64")]
    shape = (1, COLUMNS)
    row: dict[str, np.ndarray] = {
        "object": np.empty(shape, np.int32), "t": np.empty(shape), "image": np.empty((*shape, 3)),
    }  # fmt: skip
    _core.render(scene.native_view(), rows, row, None)
    for name, found in row.items():
        assert found[0].tobytes() == all_of_it[name][16].tobytes()
