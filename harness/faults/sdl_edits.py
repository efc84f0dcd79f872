"""Edits of the description that the lane `povray` writes (`translators/povray/sdl.py`).

Each takes the scene and the text and returns another text, or the same where there is nothing to
break. Lines are told apart by what the translator puts into them: what is seen has a texture, what
only casts a shadow says `no_image`.
"""

from __future__ import annotations

import re
from collections.abc import Callable

import numpy as np

from crosstrace.translators.povray.plan import plan
from crosstrace.translators.scene import KT, N, Scene

_VECTOR = r"<([^<>]*)>"
_TWIN = re.compile(r"^.* no_image no_reflection \}\n", re.MULTILINE)
_VISIBLE = re.compile(r"^(.*\btexture \{.*) \}$", re.MULTILINE)
_SEEN_LAST = re.compile(
    r"(?:light_group \{\n(?:(?!light_group).*\n)*  global_lights off \}\n|^.*\btexture \{.*\n)"
    r"(?:.* no_image no_reflection \}\n)?\Z",
    re.MULTILINE,
)


def without_shadows(scene: Scene, text: str) -> str:
    """Let nothing cast a shadow."""

    def unshaded(line: re.Match[str]) -> str:
        return line[0] if "no_shadow" in line[1] else f"{line[1]} no_shadow }}"

    return _VISIBLE.sub(unshaded, without_shadow_twins(scene, text))


def without_shadow_twins(scene: Scene, text: str) -> str:
    """Drop the black twins that cast the shadows of glass: it casts none then."""
    return _TWIN.sub("", text)


def filtered_shadows(scene: Scene, text: str) -> str:
    """Let glass cast POV-Ray's own shadow, filtered by its colour, in its twin's place."""
    bare = _TWIN.sub("", text)
    return bare if bare == text else bare.replace(" no_shadow }", " }")


def one_level_fewer(scene: Scene, text: str) -> str:
    """Take max_depth for max_trace_level, which counts the primary ray too."""
    return re.sub(
        r"max_trace_level (\d+)", lambda m: f"max_trace_level {max(1, int(m[1]) - 1)}", text
    )


def default_bailout(scene: Scene, text: str) -> str:
    """Leave adc_bailout as POV-Ray has it: rays that carry less than 1/255 are left out."""
    return re.sub(r"^  adc_bailout .*\n", "", text, flags=re.MULTILINE)


def indices_as_given(scene: Scene, text: str) -> str:
    """Write n itself as an object's index, which POV-Ray takes as absolute."""
    rows = plan(scene).index
    given = iter(scene.material[rows[scene.material[rows, KT] > 0], N])

    def index(old: re.Match[str]) -> str:
        n = float(next(given))
        return old[0] if np.float32(n) == np.float32(float(old[1])) else f"ior {n!r} }}"

    return re.sub(r"ior (\S+) \}", index, text)


def exponents_off(scene: Scene, text: str) -> str:
    """Add 1 to every phong_size."""
    return re.sub(r"phong_size (\S+)", lambda m: f"phong_size {float(m[1]) + 1!r}", text)


def without_the_last_object(scene: Scene, text: str) -> str:
    """Stop writing one object too early."""
    return _SEEN_LAST.sub("", text)


def decoded_gamma(scene: Scene, text: str) -> str:
    """Declare the colours to be encoded with gamma 2.2: they come out decoded once too often."""
    return text.replace("assumed_gamma 1 ", "assumed_gamma 2.2 ")


def mirrored(scene: Scene, text: str) -> str:
    """Negate the camera's `right`."""
    return _camera(text, lambda direction, right, up: (direction, -right, up))


def axes_swapped(scene: Scene, text: str) -> str:
    """Let `right` point along v and `up` along u, each as long as before."""

    def swap(direction: _Axis, right: _Axis, up: _Axis) -> tuple[_Axis, _Axis, _Axis]:
        across, along = np.linalg.norm(right), np.linalg.norm(up)
        return direction, up * (across / along), right * (along / across)

    return _camera(text, swap)


def half_pixel_right(scene: Scene, text: str) -> str:
    """Send the rays through the left edges of the pixels: the picture moves half a pixel right."""

    def shift(direction: _Axis, right: _Axis, up: _Axis) -> tuple[_Axis, _Axis, _Axis]:
        return direction - right * (0.5 / scene.h_res), right, up

    return _camera(text, shift)


_Axis = np.ndarray[tuple[int, ...], np.dtype[np.float64]]
_CAMERA = re.compile(rf"direction {_VECTOR}\n  right {_VECTOR} up {_VECTOR}")


def _camera(text: str, change: Callable[[_Axis, _Axis, _Axis], tuple[_Axis, _Axis, _Axis]]) -> str:
    def written(axis: _Axis) -> str:
        return f"<{', '.join(repr(float(v)) for v in axis)}>"

    def camera(old: re.Match[str]) -> str:
        axes = (np.array([float(v) for v in group.split(",")]) for group in old.groups())
        direction, right, up = map(written, change(*axes))
        return f"direction {direction}\n  right {right} up {up}"

    return _CAMERA.sub(camera, text)
