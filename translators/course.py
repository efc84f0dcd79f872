"""The course's text format, read and written (specification 2.4, 3.4, 4.3).

Reading is the native part's; writing prints every number in the shortest form that reads back to
the same double.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from crosstrace.native import _core
from crosstrace.translators.errors import SceneError, UsageError
from crosstrace.translators.scene import SPHERE, Array, Scene

#: How many numbers of a material a delivery's files state.
_STATED_MATERIAL = {1: 0, 2: 4, 3: 7}
_OBJECTS_AT_ONCE = 4096


def load(path: str | Path, delivery: int | None = None) -> Scene:
    """Read a scene file; `delivery` 1, 2 or 3 overrides what the text says.

    Raises SceneError with line and column where the file is malformed or makes no sense, and
    UsageError where it cannot be read.
    """
    try:
        text = Path(path).read_bytes()
    except OSError as error:
        raise UsageError(
            f"{path}: expected a readable scene file, found: {error.strerror}"
        ) from None
    return parse(text, path=str(path), delivery=delivery)


def parse(text: bytes | str, path: str = "<scene>", delivery: int | None = None) -> Scene:
    """Read the text of a scene file; `path` names it in errors and as the Scene's origin."""
    data = text.encode() if isinstance(text, str) else text
    if delivery not in (None, 1, 2, 3):
        raise UsageError(f"expected delivery 1, 2 or 3, found {delivery!r}")
    fields, fault = _core.parse(data, delivery or 0)
    if fields is None:
        raise SceneError(path, *(fault or (0, 0, "a scene", "nothing")))
    (delivery, v_res, h_res, pixel_size, distance, eye, target, up, background, max_depth,
     kind, color, material, geometry, ambient, lights) = fields  # fmt: skip
    return Scene(
        delivery, v_res, h_res, pixel_size, distance,
        np.array(eye), np.array(target), np.array(up), np.array(background), max_depth,
        np.frombuffer(kind, np.uint8), _rows(color, 3), _rows(material, 7), _rows(geometry, 6),
        np.array(ambient), _rows(lights, 6),
        path=path, name=Path(path).stem, checked=True,
    )  # fmt: skip


def dumps(scene: Scene) -> str:
    """Write a scene as text that reads back equal, to the last bit of every number."""
    return "".join(_lines(scene))


def _rows(block: Any, columns: int) -> Array:
    return np.frombuffer(block, np.float64).reshape(-1, columns)


def _text(values: Any) -> str:
    return " ".join(_number(value) for value in np.asarray(values).tolist())


def _number(value: float) -> str:
    text = repr(value)
    return text[:-2] if text.endswith(".0") else text


def _lines(scene: Scene) -> Iterator[str]:
    yield f"{scene.v_res} {scene.h_res}\n"
    yield f"{_text([scene.pixel_size, scene.screen_distance])}\n"
    for triple in (scene.eye, scene.target, scene.up, scene.background):
        yield f"{_text(triple)}\n"
    if scene.delivery == 3:
        yield f"{scene.max_depth}\n"
    yield f"{len(scene)}\n"
    stated = _STATED_MATERIAL[scene.delivery]
    for start in range(0, len(scene), _OBJECTS_AT_ONCE):
        some = slice(start, start + _OBJECTS_AT_ONCE)
        surface = np.hstack([scene.color[some], scene.material[some, :stated]]).tolist()
        places = scene.geometry[some].tolist()
        for kind, numbers, place in zip(scene.kind[some], surface, places, strict=True):
            sign, used = ("*", 4) if kind == SPHERE else ("/", 6)
            words = [*map(_number, numbers), sign, *map(_number, place[:used])]
            yield " ".join(words) + "\n"
    if scene.delivery > 1:
        yield f"{_text(scene.ambient)}\n{scene.n_lights}\n"
        for light in scene.lights:
            yield f"{_text(light)}\n"
