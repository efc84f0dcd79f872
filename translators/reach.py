"""How many bounces it takes at least until a ray of the view can meet an object.

Every conclusion is on the safe side: an object counts as met unless the margins below, hundreds of
times what float32 rounds, say otherwise. What is concluded:

- a primary ray meets no sphere that lies outside one side of the pyramid of the picture, and none
  that a plane which lets no light through hides from the eye;
- it meets no plane that falls away from it in all four corners of the picture: how fast it nears is
  linear across the picture, so it is greatest in a corner;
- a later ray may meet anything, if some object that is met sends rays on.

The picture's corners are half a pixel outside the outermost rays.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from crosstrace.translators.scene import KT, Scene

Array = NDArray[np.float64]

#: Bounces of what no ray meets.
NEVER = np.iinfo(np.int64).max

#: Of distances from the eye, and of the coordinates that they are differences of.
_MARGIN, _COORDINATE_MARGIN = 1e-3, 1e-5
#: Planes end somewhere in some renderers (1e7 at least): nothing farther is taken as hidden.
_FARTHEST = 1e6


def bounces(scene: Scene, sends: NDArray[np.bool_]) -> NDArray[np.int64]:
    """Return for each object how many bounces come before it is met at least: 0, 1 or NEVER (n,).

    `sends` (n,) says which objects send a secondary ray when they are met.
    """
    seen = in_view(scene)
    later = 1 if bool((seen & sends).any()) and scene.max_depth > 0 else NEVER
    return np.where(seen, 0, later).astype(np.int64)


def in_view(scene: Scene) -> NDArray[np.bool_]:
    """Say which objects a primary ray may meet (n,)."""
    corners = _corners(scene)
    if not np.isfinite(corners).all():
        return np.ones(len(scene), bool)
    seen = np.ones(len(scene), bool)
    balls = np.flatnonzero(scene.is_sphere)
    planes = np.flatnonzero(~scene.is_sphere)
    if len(balls):
        seen[balls] = _meets_balls(scene, balls, corners)
    for i in planes:
        seen[i] = _meets_plane(scene, int(i), corners)
        if len(balls) and scene.material[i, KT] == 0:
            seen[balls] &= ~_hides(scene, int(i), balls)
    return seen


def _corners(scene: Scene) -> Array:
    """Return the directions to the picture's corners, of length 1, one after the other (4, 3)."""
    w = _unit(scene.eye - scene.target)
    u = _unit(np.cross(_unit(scene.up), w))
    v = np.cross(w, u)
    x = scene.pixel_size * scene.h_res / 2
    y = scene.pixel_size * scene.v_res / 2
    signs = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)], float)
    ways = signs[:, :1] * x * u + signs[:, 1:] * y * v - scene.screen_distance * w
    return np.array([_unit(way) for way in ways])


def _meets_balls(scene: Scene, balls: NDArray[np.intp], corners: Array) -> NDArray[np.bool_]:
    away = scene.geometry[balls, :3] - scene.eye
    grown = scene.geometry[balls, 3] + _margin(scene, balls)
    meets = np.ones(len(balls), bool)
    middle = corners.sum(axis=0)
    for k in range(4):
        side = np.cross(corners[k], corners[(k + 1) % 4])
        length = np.linalg.norm(side)
        if not length > 1e-9:
            continue  # too narrow a picture for this side to be known
        side *= (1 if side @ middle > 0 else -1) / length
        meets &= ~(away @ side < -grown)
    return meets


def _meets_plane(scene: Scene, i: int, corners: Array) -> bool:
    point, normal = scene.geometry[i, :3], _unit(scene.geometry[i, 3:])
    rise = float(normal @ (point - scene.eye))
    if not abs(rise) > _coordinates(scene, scene.geometry[i : i + 1, :3])[0]:
        return True
    return not bool((np.sign(rise) * (corners @ normal) < -_MARGIN).all())


def _hides(scene: Scene, i: int, balls: NDArray[np.intp]) -> NDArray[np.bool_]:
    """Say which spheres lie wholly behind plane i, seen from the eye."""
    point, normal = scene.geometry[i, :3], _unit(scene.geometry[i, 3:])
    height = float(normal @ (scene.eye - point))
    margin = _margin(scene, balls) + _coordinates(scene, point[None])[0]
    above = np.sign(height) * ((scene.geometry[balls, :3] - point) @ normal)
    far = np.linalg.norm(scene.geometry[balls, :3] - scene.eye, axis=1) + scene.geometry[balls, 3]
    known = (abs(height) > margin) & (far < _FARTHEST)
    hidden: NDArray[np.bool_] = known & (above < -(scene.geometry[balls, 3] + margin))
    return hidden


def _margin(scene: Scene, balls: NDArray[np.intp]) -> Array:
    place, radius = scene.geometry[balls, :3], scene.geometry[balls, 3]
    distance = np.linalg.norm(place - scene.eye, axis=1) + radius
    return np.asarray(_MARGIN * distance + _coordinates(scene, place))


def _coordinates(scene: Scene, places: Array) -> Array:
    margin: Array = _COORDINATE_MARGIN * (np.abs(places).sum(axis=1) + np.abs(scene.eye).sum())
    return margin


def _unit(a: Array) -> Array:
    scaled = a / np.abs(a).max()
    unit: Array = scaled / np.linalg.norm(scaled)
    return unit
