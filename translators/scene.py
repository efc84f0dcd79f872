"""A Scene: the float64 numbers of one course-format file, as plain arrays.

A Scene is its numbers (section 1 of the design): two Scenes are equal when every number is equal to
the last bit, however it was spelled. Objects stand in arrays, so a million spheres cost 129 bytes
each and no Python objects.
"""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from enum import IntEnum
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crosstrace.native import _core
from crosstrace.translators.errors import SceneError

Array = NDArray[np.float64]

SPHERE = 0
PLANE = 1

#: Columns of `Scene.material`.
KA, KD, KS, ETA, KR, KT, N = range(7)


class Delivery(IntEnum):
    """Which of the course's three deliveries a scene belongs to."""

    RAY_CASTING = 1
    PHONG = 2
    WHITTED = 3


#: What `material` holds where a delivery does not state it: no light beyond the object's own colour
#: in the first, no secondary rays in the second.
DEFAULT_MATERIAL: dict[int, tuple[float, ...]] = {
    1: (1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0),
    2: (0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0),
    3: (0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0),
}


def sphere(
    color: Sequence[float], center: Sequence[float], radius: float, **material: float
) -> dict[str, Any]:
    """Describe a sphere for `Scene.build`: colour in 0…255, world units, ka kd ks eta kr kt n."""
    geometry = (*map(float, center), float(radius), 0.0, 0.0)
    return {"kind": SPHERE, "color": color, "geometry": geometry, "material": material}


def plane(
    color: Sequence[float], point: Sequence[float], normal: Sequence[float], **material: float
) -> dict[str, Any]:
    """Describe a plane for `Scene.build`: the normal need not be of length 1."""
    geometry = (*map(float, point), *map(float, normal))
    return {"kind": PLANE, "color": color, "geometry": geometry, "material": material}


@dataclass(frozen=True, eq=False)
class Scene:
    """One scene; arrays are float64, C-contiguous and read-only.

    Colours are on the file's scale 0…255; lengths are world units. `material` has the columns
    ka kd ks η kr kt n, `geometry` is centre and radius then two zeros for a sphere, point and
    normal for a plane, `lights` is colour then position. Deliveries 1 and 2 hold the values of
    `DEFAULT_MATERIAL` in the columns that their files lack, white ambient light in delivery 1, and
    max_depth 0. `path` and `name` say where it came from and take no part in equality.
    """

    delivery: int
    v_res: int
    h_res: int
    pixel_size: float
    screen_distance: float
    eye: Array
    target: Array
    up: Array
    background: Array
    max_depth: int = 0
    kind: NDArray[np.uint8] = field(default_factory=lambda: np.zeros(0, np.uint8))
    color: Array = field(default_factory=lambda: np.zeros((0, 3)))
    material: Array = field(default_factory=lambda: np.zeros((0, 7)))
    geometry: Array = field(default_factory=lambda: np.zeros((0, 6)))
    ambient: Array = field(default_factory=lambda: np.full(3, 255.0))
    lights: Array = field(default_factory=lambda: np.zeros((0, 6)))
    path: str = field(default="<scene>", compare=False)
    name: str = field(default="scene", compare=False)
    checked: bool = field(default=False, compare=False, repr=False)

    def __post_init__(self) -> None:
        """Freeze the arrays, check shapes here and the meaning of every number in the native part.

        Raises SceneError (without line and column; `where` names the field).
        """
        n, m = len(self.kind), len(self.lights)
        shapes: dict[str, tuple[int, ...]] = {
            "eye": (3,), "target": (3,), "up": (3,), "background": (3,), "ambient": (3,),
            "color": (n, 3), "material": (n, 7), "geometry": (n, 6), "lights": (m, 6),
        }  # fmt: skip
        for name, shape in shapes.items():
            array = np.array(getattr(self, name), dtype=np.float64, order="C", copy=None)
            if array.shape != shape:
                raise self._error(name, f"an array of shape {shape}", f"shape {array.shape}")
            object.__setattr__(self, name, _frozen(array))
        kind = np.array(self.kind, dtype=np.uint8, order="C", copy=None)
        object.__setattr__(self, "kind", _frozen(kind))
        if not self.checked:
            self._check()
            object.__setattr__(self, "checked", True)

    def _check(self) -> None:
        for name in ("delivery", "v_res", "h_res", "max_depth"):
            value = getattr(self, name)
            if not isinstance(value, int | np.integer):
                raise self._error(name, "an integer", repr(value))
            object.__setattr__(self, name, int(value))
        for name in ("pixel_size", "screen_distance"):
            object.__setattr__(self, name, float(getattr(self, name)))
        fault = _core.check_scene(self.native_view())
        if fault is not None:
            raise self._error(*fault)

    def _error(self, where: str, expected: str, found: str) -> SceneError:
        return SceneError(self.path, 0, 0, expected, found, where)

    @classmethod
    def build(
        cls, *, objects: Sequence[dict[str, Any]] = (), lights: Sequence[Any] = (), **camera: Any
    ) -> Scene:
        """Build a small scene from `sphere(…)` and `plane(…)` and (colour, position) lights.

        Raises SceneError where a number makes no sense, TypeError for an unknown material name.
        """
        names = ("ka", "kd", "ks", "eta", "kr", "kt", "n")
        defaults = DEFAULT_MATERIAL.get(camera.get("delivery", 3), DEFAULT_MATERIAL[3])
        materials = []
        for item in objects:
            if unknown := set(item["material"]) - set(names):
                raise TypeError(f"unknown material names: {sorted(unknown)}")
            stated = item["material"]
            materials.append([stated.get(k, v) for k, v in zip(names, defaults, strict=True)])
        return cls(
            kind=np.array([o["kind"] for o in objects], np.uint8),
            color=np.array([o["color"] for o in objects], np.float64).reshape(-1, 3),
            geometry=np.array([o["geometry"] for o in objects], np.float64).reshape(-1, 6),
            material=np.array(materials, np.float64).reshape(-1, 7),
            lights=np.array([[*c, *p] for c, p in lights], np.float64).reshape(-1, 6),
            **camera,
        )

    def native_view(self) -> tuple[Any, ...]:
        """Return the fields in the order in which `crosstrace.native._core` takes a scene."""
        return (
            self.delivery, self.v_res, self.h_res, self.pixel_size, self.screen_distance,
            self.eye, self.target, self.up, self.background, self.max_depth,
            self.kind, self.color, self.material, self.geometry, self.ambient, self.lights,
        )  # fmt: skip

    @cached_property
    def sha256(self) -> str:
        """Content hash: of the numbers alone, so that spelling, layout and names do not count."""
        digest = hashlib.sha256(b"crosstrace scene 1\0")
        integers = [self.delivery, self.v_res, self.h_res, self.max_depth, len(self), self.n_lights]
        digest.update(np.array(integers, "<i8").tobytes())
        digest.update(self.kind.tobytes())
        scalars = np.array([self.pixel_size, self.screen_distance])
        for array in (scalars, self.eye, self.target, self.up, self.background, self.color,
                      self.material, self.geometry, self.ambient, self.lights):  # fmt: skip
            # Adding zero gives −0 and 0 the same bytes: they are one number, spelled twice.
            digest.update((array + 0.0).astype("<f8", copy=False).tobytes())
        return digest.hexdigest()

    def __len__(self) -> int:
        """Return the number of objects."""
        return len(self.kind)

    @property
    def n_lights(self) -> int:
        """The number of point lights."""
        return len(self.lights)

    @property
    def shape(self) -> tuple[int, int, int]:
        """The shape of an image of this scene: (v_res, h_res, 3)."""
        return self.v_res, self.h_res, 3

    @property
    def is_sphere(self) -> NDArray[np.bool_]:
        """Which objects are spheres, (n,)."""
        return np.equal(self.kind, SPHERE)

    def __eq__(self, other: object) -> bool:
        """Equal to the last bit of every number; −0 and 0 are told apart."""
        if not isinstance(other, Scene):
            return NotImplemented
        for mine, theirs in zip(self.native_view(), other.native_view(), strict=True):
            if np.asarray(mine).tobytes() != np.asarray(theirs).tobytes():
                return False
        return True

    def __hash__(self) -> int:
        """Hash by content."""
        return int(self.sha256[:15], 16)

    def resized(self, v_res: int, h_res: int) -> Scene:
        """Return the scene at another resolution with the same horizontal field of view."""
        size = self.pixel_size * (self.h_res / h_res) if h_res > 0 else self.pixel_size
        return replace(self, v_res=v_res, h_res=h_res, pixel_size=size, checked=False)


def _frozen(array: NDArray[Any]) -> NDArray[Any]:
    # What somebody can still write to is copied, so that a validated number stays as it was.
    own = array.copy() if array.flags.writeable else array
    own.flags.writeable = False
    return own
