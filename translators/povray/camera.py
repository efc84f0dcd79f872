"""The camera: its vectors as POV-Ray takes them, and on which side of each surface it stands."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from crosstrace.translators.povray.plan import Array, Plan
from crosstrace.translators.scene import Scene

#: A camera this close to a surface, in units in the last place, lies on it.
_ULPS = 4

#: Four times POV-Ray's EPSILON: a point less than that in front of a plane counts as behind it,
#: whichever way the plane faces (`planes.cpp`).
_CLEARANCE = 4e-10


@dataclass(frozen=True)
class CameraSide:
    """Where the camera stands, a mask (n,) each; `height` over the surface in world units.

    `inside`: in the object, or on its surface and looking inwards. `on`: on the surface. `torn`: on
    the surface and looking to both sides. `listed`: POV-Ray would find the camera inside, and so
    start every ray in that object's interior. `shift` is what a plane is moved along its normal, in
    POV-Ray's units, for a camera on it to stand clearly on one side: less than any hit that counts.
    """

    inside: NDArray[np.bool_]
    on: NDArray[np.bool_]
    torn: NDArray[np.bool_]
    listed: NDArray[np.bool_]
    height: Array
    shift: Array


def basis(scene: Scene) -> tuple[Array, Array, Array]:
    """Return u, v, w of section 2.3 of the specification."""
    w = _unit(scene.eye - scene.target)
    u = _unit(np.cross(_unit(scene.up), w))
    return u, np.cross(w, u), w


def camera_side(plan: Plan, scale: float) -> CameraSide:
    """Work out the camera's side of every surface; `scale` is the world scale."""
    scene = plan.scene
    eye, position = scene.eye, plan.geometry[:, :3]
    offset = eye - position
    normal = np.where(plan.sphere[:, None], offset, plan.geometry[:, 3:])
    radius = np.where(plan.sphere, plan.geometry[:, 3], 0.0)

    height = np.where(plan.sphere, np.linalg.norm(offset, axis=1) - radius, _dot(offset, normal))
    size = np.abs(eye) + np.abs(position)
    size = np.where(plan.sphere, size.max(axis=1) + radius, _dot(size, np.abs(normal)))
    on = np.abs(height) <= _ULPS * np.finfo(float).eps * size

    # The four corner rays span all primary rays, so they tell to which side a camera looks.
    u, v, w = basis(scene)
    x = scene.pixel_size * (scene.h_res - 1) / 2
    y = scene.pixel_size * (scene.v_res - 1) / 2
    corners = [i * x * u + j * y * v - scene.screen_distance * w for i in (-1, 1) for j in (-1, 1)]
    rising = np.array(corners) @ normal.T
    inwards, outwards = (rising <= 0).all(axis=0), (rising >= 0).all(axis=0)

    inside = np.where(on, inwards, height < 0)
    clearance = _CLEARANCE + 2 * _ULPS * np.finfo(float).eps * size * scale
    close = ~plan.sphere & (np.abs(height) * scale < clearance)
    return CameraSide(
        inside=inside,
        on=on,
        torn=on & ~inwards & ~outwards,
        # What POV-Ray itself computes for a sphere, to the last bit.
        listed=np.where(plan.sphere, (offset**2).sum(axis=1) < radius**2, inside),
        height=height,
        shift=np.where(close, np.where(inside, clearance, -clearance), 0.0),
    )


def _dot(a: Array, b: Array) -> Array:
    return np.asarray((a * b).sum(axis=1))


def _unit(v: Array) -> Array:
    v = v / np.abs(v).max()
    return np.asarray(v / np.linalg.norm(v))
