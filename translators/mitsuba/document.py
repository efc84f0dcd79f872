"""A Scene in Mitsuba's terms: which plugins stand for the camera, the objects and the lights.

Three documents: `stock` for the first delivery (nothing of this project in it), `single` for the
later ones in float32 (stock shapes, our camera, material, light and integrator) and `double` (our
plugins alone).
"""

from __future__ import annotations

import math
from collections.abc import Collection

import numpy as np

from crosstrace.translators.effects import EFFECTS
from crosstrace.translators.mitsuba.camera import Array, foot, unit
from crosstrace.translators.mitsuba.elements import Element, Matrix, Point, Reference, Rgb, Value
from crosstrace.translators.scene import KR, KT, Scene

#: Rays start at this distance in front of the eye, along the view: `perspective`'s default.
NEAR = 1e-2
#: Half the width of a plane: `disk` is as accurate at any size.
DISK = 1e8
#: The shell of the stock document is this much wider than everything in it.
SHELL = 100.0
#: The widest picture that `perspective` takes; it fails where float32 makes it 180 degrees.
WIDEST_DEGREES = 179.0


def stock(scene: Scene) -> list[Element]:
    """Return delivery 1 for Mitsuba's own `aov` and `perspective`.

    The channels are `color` (the image: the albedo of whatever is seen) and `object` (Mitsuba's
    number of the shape). A sphere around everything wears the background colour.
    """
    _, first, which = np.unique(scene.color, axis=0, return_index=True, return_inverse=True)
    paints = [_paint(scene.color[i], f"paint_{k}") for k, i in enumerate(first)]
    worn = which.ravel()
    shapes = [_shape(scene, i, Reference(f"paint_{worn[i]}")) for i in _distinct(scene)]
    shell: dict[str, Value] = {
        "center": Point(_triple(scene.eye)), "radius": SHELL * _extent(scene),
        "material": Reference("paint_background"),
    }  # fmt: skip
    paints.append(_paint(scene.background, "paint_background"))
    shapes.append(Element("shape", "sphere", "background", shell))
    aov = Element("integrator", "aov", "integrator", {"aovs": "color:albedo,object:shape_index"})
    values: dict[str, Value] = {
        "fov_axis": "x", "fov": field_of_view(scene), "near_clip": NEAR, "far_clip": 1e30,
        "to_world": _look_at(scene),
    }  # fmt: skip
    return [aov, Element("sensor", "perspective", "sensor", values, _film(scene)), *paints, *shapes]


def is_stock(scene: Scene, effects: Collection[str]) -> bool:
    """Say whether nothing of this project is needed for the scene."""
    plain = scene.delivery == 1 and set(effects) == ({"flat"} if len(scene) else set())
    return plain and field_of_view(scene) <= WIDEST_DEGREES


def field_of_view(scene: Scene) -> float:
    """Return the width of the picture in degrees."""
    return 2 * math.degrees(math.atan(scene.pixel_size * scene.h_res / (2 * scene.screen_distance)))


def single(scene: Scene, effects: Collection[str]) -> list[Element]:
    """Return any delivery in float32: stock shapes and ray queries, our shading and recursion."""
    keys = np.concatenate([scene.color, scene.material], axis=1)
    _, first, which = np.unique(keys, axis=0, return_index=True, return_inverse=True)
    materials = [_phong(scene, i, f"material_{k}", effects) for k, i in enumerate(first)]
    worn = which.ravel()
    shapes = [_shape(scene, i, Reference(f"material_{worn[i]}")) for i in _distinct(scene)]
    whitted = Element("integrator", "crosstrace_whitted", "integrator", _recursion(scene, effects))
    return [whitted, _pinhole(scene), *materials, *shapes, *_lights(scene)]


def double(scene: Scene, effects: Collection[str]) -> list[Element]:
    """Return any delivery in float64: the objects stand in the integrator, as materials."""
    objects = []
    for i in range(len(scene)):
        place, rest = scene.geometry[i, :3], scene.geometry[i, 3:]
        surface: dict[str, Value] = {"place": Point(_triple(place))}
        if scene.is_sphere[i]:
            surface |= {"surface": "sphere", "radius": float(rest[0])}
        else:
            surface |= {"surface": "plane", "normal": Point(_triple(rest))}
        objects.append(_phong(scene, i, f"object_{i}", effects, surface))
    values = _recursion(scene, effects)
    whitted = Element("integrator", "crosstrace_whitted_f64", "integrator", values, tuple(objects))
    return [whitted, _pinhole(scene), *_lights(scene)]


def branches(scene: Scene, effects: Collection[str]) -> bool:
    """Say whether one hit can spawn two rays."""
    both = (scene.material[:, KR] > 0) & (scene.material[:, KT] > 0)
    return {"reflection", "refraction"} <= set(effects) and bool(both.any())


def _recursion(scene: Scene, effects: Collection[str]) -> dict[str, Value]:
    return {
        "ambient": Point(_triple(scene.ambient)),
        "background": Point(_triple(scene.background)),
        "max_depth": min(scene.max_depth, 2**31 - 1),
        "effects": " ".join(name for name in EFFECTS if name in effects),
        "branches": branches(scene, effects),
    }


def _phong(
    scene: Scene, i: int, name: str, effects: Collection[str],
    surface: dict[str, Value] | None = None,
) -> Element:  # fmt: skip
    names = ("ka", "kd", "ks", "eta", "kr", "kt", "n")
    numbers = map(float, scene.material[i])
    values: dict[str, Value] = {"color": Point(_triple(scene.color[i]))}
    values |= dict(zip(names, numbers, strict=True))
    values["total_reflection"] = "total_reflection" in effects
    return Element("bsdf", "crosstrace_phong", name, values | (surface or {}))


def _distinct(scene: Scene) -> list[int]:
    """Return the objects without those whose surface an earlier one has, number for number.

    At equal distance the object first in the file wins, so the others cannot be seen, and what they
    block the first one blocks; Mitsuba's ray queries would take either.
    """
    keys = np.column_stack([scene.kind, scene.geometry])
    return [int(i) for i in np.sort(np.unique(keys, axis=0, return_index=True)[1])]


def _shape(scene: Scene, i: int, material: Reference) -> Element:
    place, rest = scene.geometry[i, :3], scene.geometry[i, 3:]
    if scene.is_sphere[i]:
        ball: dict[str, Value] = {"center": Point(_triple(place)), "radius": float(rest[0])}
        return Element("shape", "sphere", f"object_{i}", ball | {"material": material})
    disk: dict[str, Value] = {"to_world": _disk(scene.eye, place, rest), "material": material}
    return Element("shape", "disk", f"object_{i}", disk)


def _disk(eye: Array, point: Array, normal: Array) -> Matrix:
    """Return the transformation of the unit disk: centred at the eye's foot, the normal exact."""
    n = unit(normal)
    across = unit(np.cross(n, np.eye(3)[int(np.abs(n).argmin())]))
    columns = (DISK * across, DISK * np.cross(n, across), n, foot(eye, point, normal))
    rows = np.vstack([np.stack(columns, axis=1), [0.0, 0.0, 0.0, 1.0]])
    return Matrix(tuple(map(float, rows.ravel())))


def _look_at(scene: Scene) -> Matrix:
    """Return `perspective`'s frame: x to the left, y up, z along the view."""
    z = unit(scene.target - scene.eye)
    x = unit(np.cross(unit(scene.up), z))
    columns = (x, np.cross(z, x), z, scene.eye)
    rows = np.vstack([np.stack(columns, axis=1), [0.0, 0.0, 0.0, 1.0]])
    return Matrix(tuple(map(float, rows.ravel())))


def _pinhole(scene: Scene) -> Element:
    values: dict[str, Value] = {
        "eye": Point(_triple(scene.eye)),
        "target": Point(_triple(scene.target)),
        "up": Point(_triple(scene.up)),
        "pixel_size": scene.pixel_size,
        "screen_distance": scene.screen_distance,
        "near": NEAR,
    }
    return Element("sensor", "crosstrace_pinhole", "sensor", values, _film(scene))


def _film(scene: Scene) -> tuple[Element, Element]:
    """Return a film and a sampler that sees each pixel once, through its centre."""
    box = Element("rfilter", "box", "filter")
    values: dict[str, Value] = {
        "width": scene.h_res, "height": scene.v_res, "pixel_format": "rgb",
        "component_format": "float32",
    }  # fmt: skip
    film = Element("film", "hdrfilm", "film", values, (box,))
    centres: dict[str, Value] = {"sample_count": 1, "jitter": False}
    return film, Element("sampler", "stratified", "sampler", centres)


def _lights(scene: Scene) -> list[Element]:
    lights = []
    for j, row in enumerate(scene.lights):
        values: dict[str, Value] = {
            "color": Point(_triple(row[:3])), "position": Point(_triple(row[3:]))
        }  # fmt: skip
        lights.append(Element("emitter", "crosstrace_point", f"light_{j}", values))
    return lights


def _paint(color: Array, name: str) -> Element:
    return Element("bsdf", "diffuse", name, {"reflectance": Rgb(_triple(color / 255))})


def _extent(scene: Scene) -> float:
    """Return a length that no surface of the document exceeds, seen from the eye."""
    away = np.abs(scene.geometry[:, :3] - scene.eye).sum(axis=1) + np.abs(scene.geometry[:, 3])
    return float(away.max(where=scene.is_sphere, initial=DISK))


def _triple(values: Array) -> tuple[float, float, float]:
    x, y, z = map(float, values)
    return x, y, z
