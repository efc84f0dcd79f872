"""What POV-Ray is asked to draw: a Scene reduced to the effects wanted, as plain arrays.

Three things are settled here, before any text is written: which effects are on, object by object;
which surfaces can be seen at all (of coincident ones the first in the file hides the others, an
exact tie that POV-Ray would decide by its traversal order); and whether POV-Ray can do it.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from crosstrace.translators.effects import BIT, effects, mask, of_delivery
from crosstrace.translators.errors import UnsupportedSceneError
from crosstrace.translators.scene import KA, KD, KR, KS, KT, SPHERE, Scene

Array = NDArray[np.float64]

#: POV-Ray cuts max_trace_level to 256 with no more than a warning (`configbackend.h`).
MAX_DEPTH = 255

#: In a scene that asks for more than MAX_DEPTH, rays that carry less than this share of a pixel are
#: left out: far below float32.
NEGLIGIBLE = 1e-10


@dataclass(frozen=True)
class Plan:
    """The scene as POV-Ray gets it; `index` (n,) says which object of the Scene each row is.

    `color`, `ambient` and the first three columns of `lights` are on 0…1; `material` has zeros
    where an effect is off; planes in `geometry` have unit normals. `depth` is 0 where no object
    sends a secondary ray, otherwise at most MAX_DEPTH; `deep` says that the scene asks for more.
    """

    scene: Scene
    index: NDArray[np.intp]
    sphere: NDArray[np.bool_]
    geometry: Array
    color: Array
    material: Array
    ambient: Array
    lights: Array
    depth: int
    deep: bool
    shadows: bool

    def __len__(self) -> int:
        """Return the number of surfaces that can be seen."""
        return len(self.index)

    @property
    def quality(self) -> int:
        """POV-Ray's `Quality`: 8 traces secondary rays, 4 shadow rays, 2 neither."""
        if self.depth:
            return 8
        return 4 if self.shadows and len(self.lights) else 2


def plan(scene: Scene, requested: frozenset[str] | None = None) -> Plan:
    """Reduce a scene to the effects requested (None: those that it calls for).

    Raises UnsupportedSceneError where POV-Ray cannot leave out what was left out.
    """
    index = _first_of_coincident(scene)
    called_for = effects(scene)
    if requested is None:
        wanted, objects = called_for.overall, called_for.objects[index]
    else:
        wanted = mask(requested & of_delivery(scene.delivery))
        objects = np.full(len(index), wanted, np.uint16)
    material = scene.material[index].copy()
    for columns, names in (
        ((KA,), ("flat", "ambient")),
        ((KD,), ("diffuse",)),
        ((KS,), ("specular",)),
        ((KR,), ("reflection",)),
        ((KT,), ("refraction",)),
    ):
        off = (objects & np.uint16(mask(names))) == 0
        for column in columns:
            material[off, column] = 0.0
    lit = material[:, KD].any() or material[:, KS].any()
    depth = scene.max_depth if material[:, KR].any() or material[:, KT].any() else 0
    bright = (scene.lights[:, :3] > 0).any(axis=1) | (requested is not None)
    lights = scene.lights[bright] if lit else np.zeros((0, 6))
    made = Plan(
        scene=scene,
        index=index,
        sphere=scene.is_sphere[index],
        geometry=_unit_normals(scene)[index],
        color=scene.color[index] / 255,
        material=material,
        ambient=scene.ambient / 255,
        lights=lights / ([255.0] * 3 + [1.0] * 3),
        depth=min(depth, MAX_DEPTH),
        deep=depth > MAX_DEPTH,
        shadows=bool(wanted & BIT["shadows"]),
    )
    _refuse_what_cannot_be_left_out(made, called_for.objects[index], wanted)
    return made


def _refuse_what_cannot_be_left_out(
    made: Plan, called_for: NDArray[np.uint16], wanted: int
) -> None:
    transparent = (called_for & BIT["refraction"]) > 0
    bends = (called_for & BIT["total_reflection"]) > 0
    apart = bool(wanted & BIT["refraction"]) != bool(wanted & BIT["total_reflection"])
    if apart and (transparent & bends).any():
        raise UnsupportedSceneError(
            "POV-Ray traces refraction and total reflection together: expected both or neither"
        )


def _unit_normals(scene: Scene) -> Array:
    """Return the geometry with plane normals of length 1, without overflow on the way."""
    geometry = scene.geometry.copy()
    planes = ~scene.is_sphere
    normal = geometry[planes, 3:]
    normal = normal / np.abs(normal).max(axis=1, keepdims=True, initial=0.0)
    geometry[planes, 3:] = normal / np.linalg.norm(normal, axis=1, keepdims=True)
    return geometry


def _first_of_coincident(scene: Scene) -> NDArray[np.intp]:
    """Return the indices of the objects that no earlier object hides completely, in file order.

    Planes coincide in exact arithmetic, however their points and normals are written.
    """
    kept = np.ones(len(scene), bool)
    spheres = np.flatnonzero(scene.kind == SPHERE)
    if len(spheres):
        rows = np.ascontiguousarray(scene.geometry[spheres, :4] + 0.0)
        _, first = np.unique(rows.view("V32").ravel(), return_index=True)
        kept[spheres] = False
        kept[spheres[first]] = True
    seen: set[tuple[Fraction, ...]] = set()
    for i in np.flatnonzero(scene.kind != SPHERE):
        key = _canonical_plane(scene.geometry[i])
        kept[i] = key not in seen
        seen.add(key)
    return np.flatnonzero(kept)


def _canonical_plane(geometry: Array) -> tuple[Fraction, ...]:
    point, normal = [[Fraction(float(v)) for v in part] for part in np.split(geometry, 2)]
    scale = next(v for v in normal if v)
    offset = sum((p * n for p, n in zip(point, normal, strict=True)), Fraction(0))
    return *(n / scale for n in normal), offset / scale
