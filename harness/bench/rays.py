"""The rays of a picture, to measure intersection alone with: primary, to a lamp, mirrored."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from crosstrace.translators.native.intersect import nearest
from crosstrace.translators.scene import Scene

Array = NDArray[np.float64]

#: So many rays are enough, and more than any cache holds.
MOST_RAYS = 2**20
#: How far along their way rays start from a surface (specification 3.3).
_EPSILON = 1e-5
#: Renderers trace a picture in tiles of about this side, so the rays come in their order.
_TILE = 16


@dataclass(frozen=True)
class Rays:
    """Rays of one kind: origins and directions of length 1, (3, n) each, in the picture's order.

    That is tile by tile, and by rows within.
    """

    kind: str
    origins: Array
    directions: Array

    def __len__(self) -> int:
        """Return the number of rays."""
        return int(self.origins.shape[1])


def of_picture(scene: Scene) -> list[Rays]:
    """Return the rays of a scene's picture, with no more pixels than `MOST_RAYS`."""
    share = math.sqrt(MOST_RAYS / (scene.v_res * scene.h_res))
    if share < 1:
        scene = scene.resized(int(share * scene.v_res) or 1, int(share * scene.h_res) or 1)
    primary = _primary(scene)
    t, hit, _ = nearest(scene, primary.origins, primary.directions)
    on = hit >= 0
    if not on.any():
        return [primary]
    towards = primary.directions[:, on]
    points = primary.origins[:, on] + t[on] * towards
    normals = _normals(scene, hit[on], points)
    mirrored = towards - 2 * (towards * normals).sum(axis=0) * normals
    kinds = [primary]
    if scene.n_lights:
        way = scene.lights[0, 3:, None] - points
        kinds.append(_leaving("shadow", points, way))
    return [*kinds, _leaving("mirrored", points, mirrored)]


def _primary(scene: Scene) -> Rays:
    w = _unit(scene.eye - scene.target)
    u = _unit(np.cross(_unit(scene.up), w))
    v = np.cross(w, u)
    x = scene.pixel_size * (np.arange(scene.h_res) - scene.h_res / 2 + 0.5)
    y = -scene.pixel_size * (np.arange(scene.v_res) - scene.v_res / 2 + 0.5)
    across = x[None, :, None] * u + y[:, None, None] * v
    ways = (across - scene.screen_distance * w).reshape(-1, 3)[_by_tiles(scene)].T
    ways = np.ascontiguousarray(ways / np.linalg.norm(ways, axis=0))
    return Rays("primary", np.ascontiguousarray(np.broadcast_to(scene.eye[:, None], ways.shape)),
                ways)  # fmt: skip


def _by_tiles(scene: Scene) -> NDArray[np.intp]:
    """Return the pixels' indices, row by row within each tile."""
    row, column = np.divmod(np.arange(scene.v_res * scene.h_res), scene.h_res)
    return np.lexsort((column, row, column // _TILE, row // _TILE))


def _leaving(kind: str, points: Array, ways: Array) -> Rays:
    directions = np.ascontiguousarray(ways / np.linalg.norm(ways, axis=0))
    return Rays(kind, np.ascontiguousarray(points + _EPSILON * directions), directions)


def _normals(scene: Scene, hit: NDArray[np.int64], points: Array) -> Array:
    geometry = scene.geometry[hit].T
    normals = np.where(scene.is_sphere[hit], points - geometry[:3], geometry[3:])
    unit: Array = normals / np.linalg.norm(normals, axis=0)
    return unit


def _unit(a: Array) -> Array:
    unit: Array = a / np.linalg.norm(a)
    return unit
