"""Changes of a scene keep its meaning: they are what they say, to the last bit."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction

import numpy as np
import pytest

from crosstrace.translators.metamorphic import (
    RELATIONS,
    Relation,
    light_split,
    recolored,
    reordered,
    rotation,
    scaled,
    translated,
    turned,
    view_error,
)
from crosstrace.translators.scene import Scene, plane, sphere

CYCLE = rotation(1, 1, 1, 1)


@pytest.fixture(params=range(5))
def scene(request: pytest.FixtureRequest, random_scene: Callable[..., Scene]) -> Scene:
    """Give a random scene."""
    made: Scene = random_scene(request.param)
    return made


@pytest.mark.parametrize("relation", RELATIONS, ids=lambda relation: relation.name)
def test_every_change_is_one_and_makes_a_scene(scene: Scene, relation: Relation) -> None:
    """The changed scene passes the same validation, has the same size, and is another one."""
    changed = relation.apply(scene)
    assert changed.checked and changed.shape == scene.shape and len(changed) == len(scene)
    assert changed != scene


@pytest.mark.parametrize("k", [(1, 2, 3, 4), (9, 2, -3, 5), (1, 0, 0, 0)])
def test_rotations_are_exactly_orthogonal(k: tuple[int, int, int, int]) -> None:
    """Rows are of length 1 and at right angles, and the determinant is 1."""
    rows = rotation(*k)
    for i in range(3):
        for j in range(3):
            assert sum(a * b for a, b in zip(rows[i], rows[j], strict=True)) == Fraction(i == j)
    (a, b, c), (d, e, f), (g, h, i_) = rows
    assert a * (e * i_ - f * h) - b * (d * i_ - f * g) + c * (d * h - e * g) == 1


def test_changes_that_need_no_rounding_are_undone_exactly(scene: Scene) -> None:
    """Three turns of the axes, a power of two and back, two reversals: the scene itself again."""
    assert turned(turned(turned(scene, CYCLE), CYCLE), CYCLE) == scene
    assert scaled(scaled(scene, 1024), 1 / 1024) == scene
    assert reordered(reordered(scene)) == scene
    assert recolored(recolored(scene, (1, 2, 0)), (2, 0, 1)) == scene
    assert translated(scene, (0, 0, 0)) == scene


def test_halves_of_lights_add_up(scene: Scene) -> None:
    """Each light stands twice in its place with half its colour."""
    split = light_split(scene)
    assert split.n_lights == 2 * scene.n_lights
    assert np.array_equal(split.lights[::2, :3] + split.lights[1::2, :3], scene.lights[:, :3])
    assert np.array_equal(split.lights[::2, 3:], scene.lights[:, 3:])


def test_radii_and_directions_are_no_places() -> None:
    """A translation leaves radii and normals alone, a scaling multiplies radii and no normal."""
    scene = Scene.build(
        delivery=1, v_res=2, h_res=2, pixel_size=0.5, screen_distance=1, eye=[0, 0, 0],
        target=[0, 1, 0], up=[0, 0, 1], background=[0, 0, 0],
        objects=[sphere([1, 2, 3], [1, 2, 3], 4), plane([1, 2, 3], [1, 2, 3], [0, 3, 4])],
    )  # fmt: skip
    assert translated(scene, (1, 1, 1)).geometry.tolist() == [
        [2, 3, 4, 4, 0, 0],
        [2, 3, 4, 0, 3, 4],
    ]
    assert scaled(scene, 3).geometry.tolist() == [[3, 6, 9, 12, 0, 0], [3, 6, 9, 0, 3, 4]]
    assert turned(scene, CYCLE).geometry.tolist() == [[3, 1, 2, 4, 0, 0], [3, 1, 2, 4, 0, 3]]


def test_identical_surfaces_keep_their_order() -> None:
    """The first of two equal ones wins a tie, so it stays the first when all else is reversed."""
    objects = [sphere([k, 0, 0], [0, 5, 0], radius) for k, radius in enumerate((1, 2, 1, 3))]
    scene = Scene.build(
        delivery=1, v_res=2, h_res=2, pixel_size=0.5, screen_distance=1, eye=[0, 0, 0],
        target=[0, 1, 0], up=[0, 0, 1], background=[0, 0, 0], objects=objects,
    )  # fmt: skip
    assert reordered(scene).color[:, 0].tolist() == [3, 0, 2, 1]


def test_undo_brings_channels_back(scene: Scene) -> None:
    """An image whose channels were permuted like the colours is the original again."""
    relation = next(r for r in RELATIONS if r.name == "channels")
    image = np.random.default_rng(0).random((2, 2, 3))
    assert np.array_equal(relation.undo(image[..., list(relation.channels)]), image)
    assert np.array_equal(relation.apply(scene).background, scene.background[[1, 2, 0]])


def test_a_far_eye_turns_its_view_when_rounded(scene: Scene) -> None:
    """The bound grows with the coordinates, and what rounding really does lies within it."""
    rng = np.random.default_rng(1)
    for reach in (1.0, 1e4, 1e8):
        by = (rng.random(3) * reach).tolist()
        moved = translated(scene, by)
        before, after = scene.target - scene.eye, moved.target - moved.eye
        cross = np.cross(before, after) / (np.linalg.norm(before) * np.linalg.norm(after))
        assert np.linalg.norm(cross) <= view_error(scene, moved)
    assert view_error(scene, moved) > 1e-9
