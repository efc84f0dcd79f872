"""Scenes built in Python go through the same validation as files."""

from __future__ import annotations

import pickle
from typing import Any

import numpy as np
import pytest

from crosstrace.translators.course import parse
from crosstrace.translators.errors import SceneError
from crosstrace.translators.scene import Scene, plane, sphere

CAMERA: dict[str, Any] = {
    "delivery": 3, "v_res": 4, "h_res": 6, "pixel_size": 0.5, "screen_distance": 2.0,
    "eye": [0, 0, 5], "target": [0, 0, 0], "up": [0, 1, 0], "background": [10, 20, 30],
}  # fmt: skip


def test_a_built_scene_equals_the_same_scene_read_from_text() -> None:
    """The two ways to a Scene meet: equal, with the same hash."""
    built = Scene.build(
        **CAMERA, max_depth=2, lights=[([9, 9, 9], [1, 2, 3])],
        objects=[sphere([255, 0, 0], [0, 0, 0], 1, ka=0.1, kt=0.5, n=1.5),
                 plane([1, 2, 3], [0, 0, -1], [0, 0, 2], kd=1, eta=3)],
    )  # fmt: skip
    text = (
        "4 6 0.5 2 0 0 5 0 0 0 0 1 0 10 20 30 2 2 255 0 0 .1 0 0 1 0 .5 1.5 * 0 0 0 1 "
        "1 2 3 0 1 0 3 0 0 1 / 0 0 -1 0 0 2 255 255 255 1 9 9 9 1 2 3"
    )
    assert built == parse(text)
    assert built.sha256 == parse(text).sha256


@pytest.mark.parametrize(
    ("change", "where"),
    [
        ({"v_res": 0}, "v_res"),
        ({"v_res": 1.5}, "v_res"),
        ({"eye": [0, 0, float("nan")]}, "eye[2]"),
        ({"target": [0, 0, 5]}, "target"),
        ({"up": [0, 0, 9]}, "up"),
        ({"up": [0, 0]}, "up"),
        ({"screen_distance": 0}, "screen_distance"),
        ({"background": [0, 0, 256]}, "background[2]"),
        ({"objects": [sphere([0, 0, 0], [0, 0, 0], 0)]}, "objects[0].radius"),
        ({"objects": [plane([0, 0, 0], [0, 0, 0], [0, 0, 0])]}, "objects[0].normal"),
        ({"objects": [sphere([0, 0, 0], [0, 0, 0], 1, kr=1.1)]}, "objects[0].kr"),
        ({"objects": [sphere([0, 0, 0], [0, 0, 0], 1, kt=1, n=0)]}, "objects[0].n"),
        ({"delivery": 2, "max_depth": 1}, "max_depth"),
        ({"lights": [([0, 0, 0], [0, 0, float("inf")])]}, "lights[0].position[2]"),
    ],
)
def test_a_number_that_makes_no_sense_is_refused_by_the_name_of_its_field(
    change: dict[str, Any], where: str
) -> None:
    """There is no line to name, so the field is."""
    with pytest.raises(SceneError) as error:
        Scene.build(**(CAMERA | change))
    assert error.value.where == where
    assert "expected" in str(error.value) and "found" in str(error.value)


def test_an_unknown_material_name_is_refused() -> None:
    """A misspelt coefficient does not quietly stay at its default."""
    with pytest.raises(TypeError, match="shininess"):
        Scene.build(**CAMERA, objects=[sphere([0, 0, 0], [0, 0, 0], 1, shininess=5)])


def test_arrays_of_a_scene_cannot_be_changed() -> None:
    """What was validated stays as it was."""
    scene = Scene.build(**CAMERA)
    with pytest.raises(ValueError, match="read-only"):
        scene.eye[0] = float("nan")


def test_a_caller_who_changes_its_own_array_does_not_change_the_scene() -> None:
    """A Scene does not alias the arrays that it was built from."""
    eye = np.array([0.0, 0.0, 5.0])
    scene = Scene.build(**(CAMERA | {"eye": eye}))
    eye[2] = float("nan")
    assert scene.eye.tolist() == [0, 0, 5]


def test_a_scene_survives_pickling() -> None:
    """A worker process gets an equal scene."""
    scene = Scene.build(**CAMERA, objects=[sphere([1, 2, 3], [0, 0, 0], 1)])
    assert pickle.loads(pickle.dumps(scene, protocol=5)) == scene


def test_resizing_keeps_the_horizontal_field_of_view() -> None:
    """--size changes how many pixels there are, not what is seen from left to right."""
    scene = Scene.build(**CAMERA).resized(8, 12)
    assert scene.shape == (8, 12, 3)
    assert scene.pixel_size * scene.h_res == pytest.approx(0.5 * 6, rel=1e-15)
