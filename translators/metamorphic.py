"""Changes of a scene that must not change its picture, but for a permutation of channels.

Each keeps the meaning of the specification exactly; what a *renderer* makes of it differs by
rounding alone, unless it has a rule of its own in world units (an epsilon, a tolerance, a limit).
The numbers of the changed scene are computed in rational arithmetic and rounded once, each within
2⁻⁵³. `exact` relations need no rounding: the changed scene is this one's change to the last bit.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from crosstrace.translators.scene import Array, Scene

Vector = tuple[Fraction, Fraction, Fraction]
Matrix = tuple[Vector, Vector, Vector]

#: The specification's ε in world units, which grows with the scene.
EPSILON = 1e-5


@dataclass(frozen=True)
class Relation:
    """A change of a scene.

    `apply` makes the changed scene, whose lengths are `factor` times the original's; channel k of
    the changed image is channel `channels[k]` of the original. `moves` says that places change,
    `exact` that the changed numbers are exact, `rounds` that the same formulas in the same
    arithmetic may round otherwise, `ties` that a tie between surfaces may be decided otherwise.
    """

    name: str
    apply: Callable[[Scene], Scene]
    factor: float = 1.0
    channels: tuple[int, int, int] = (0, 1, 2)
    moves: bool = True
    exact: bool = False
    rounds: bool = True
    ties: bool = False

    @property
    def readings(self) -> dict[str, str]:
        """The readings under which the changed scene means the same."""
        return {} if self.factor == 1.0 else {"epsilon": repr(EPSILON * self.factor)}

    def undo(self, image: NDArray[np.float64]) -> NDArray[np.float64]:
        """Bring the changed scene's image (v_res, h_res, 3) back to the original's channels."""
        order = [self.channels.index(k) for k in range(3)]
        return image[..., order]


def scaled(scene: Scene, factor: float) -> Scene:
    """Multiply every length, the pixels' size and distance too."""
    by = Fraction(factor)
    geometry = scene.geometry.copy()
    lengths = np.where(scene.is_sphere, 4, 3)
    for row, n in zip(geometry, lengths.tolist(), strict=True):
        row[:n] = [_times(value, by) for value in row[:n]]
    return _moved(
        scene, lambda place: (place[0] * by, place[1] * by, place[2] * by), geometry=geometry,
        pixel_size=_times(scene.pixel_size, by), screen_distance=_times(scene.screen_distance, by),
    )  # fmt: skip


def translated(scene: Scene, by: Sequence[float]) -> Scene:
    """Move everything by a vector."""
    x, y, z = map(Fraction, by)
    move = lambda p: (p[0] + x, p[1] + y, p[2] + z)  # noqa: E731 - one line says it
    return _moved(scene, move, geometry=_places(scene, move))


def turned(scene: Scene, matrix: Matrix) -> Scene:
    """Rotate everything about the origin: places, normals, and up."""

    def turn(p: Vector) -> Vector:
        x, y, z = (r[0] * p[0] + r[1] * p[1] + r[2] * p[2] for r in matrix)
        return x, y, z

    geometry = _places(scene, turn)
    planes = ~scene.is_sphere
    geometry[planes, 3:] = _each(scene.geometry[planes, 3:], turn)
    return _moved(scene, turn, geometry=geometry, up=_each(scene.up[None], turn)[0])


def reordered(scene: Scene) -> Scene:
    """Reverse the order of the objects, but keep that of textually identical surfaces.

    These are an exact tie, which goes to the first in the file: their order is meaning.
    """
    keys = [(kind, *row) for kind, row in zip(scene.kind.tolist(), scene.geometry.tolist(),
                                              strict=True)]  # fmt: skip
    last = {key: i for i, key in enumerate(keys)}
    order = sorted(range(len(keys)), key=lambda i: (-last[keys[i]], i))
    return replace(
        scene, kind=scene.kind[order], color=scene.color[order], material=scene.material[order],
        geometry=scene.geometry[order],
    )  # fmt: skip


def light_split(scene: Scene) -> Scene:
    """Put two lights of half the colour in the place of each."""
    lights = np.repeat(scene.lights, 2, axis=0)
    lights[:, :3] *= 0.5
    return replace(scene, lights=lights, checked=False)


def recolored(scene: Scene, channels: Sequence[int]) -> Scene:
    """Permute the channels of every colour."""
    order = list(channels)
    lights = scene.lights.copy()
    lights[:, :3] = lights[:, order]
    return replace(
        scene, color=scene.color[:, order], ambient=scene.ambient[order],
        background=scene.background[order], lights=lights,
    )  # fmt: skip


def rotation(a: int, b: int, c: int, d: int) -> Matrix:
    """Return the rotation of the quaternion a + bi + cj + dk: rational, and exactly orthogonal."""
    n = Fraction(a * a + b * b + c * c + d * d)
    return (
        ((a*a + b*b - c*c - d*d) / n, 2 * (b*c - a*d) / n, 2 * (b*d + a*c) / n),
        (2 * (b*c + a*d) / n, (a*a - b*b + c*c - d*d) / n, 2 * (c*d - a*b) / n),
        (2 * (b*d - a*c) / n, 2 * (c*d + a*b) / n, (a*a - b*b - c*c + d*d) / n),
    )  # fmt: skip


def view_error(scene: Scene, changed: Scene) -> float:
    """Bound how far rounding a changed scene's numbers turns its view, in radians.

    Eye and target err by 2⁻⁵³ of their size, which counts by their distance; the view and `up` span
    the basis, so the error grows by one over the sine of their angle.
    """
    places = np.abs(np.stack([changed.eye, changed.target])).max() * np.sqrt(3)
    view = (scene.target - scene.eye) / np.linalg.norm(scene.target - scene.eye)
    up = scene.up / np.linalg.norm(scene.up)
    sine = float(np.linalg.norm(np.cross(view, up)))
    distance = float(np.linalg.norm(changed.target - changed.eye))
    return float(2.0**-53 * (1 + 2 * places / distance) / max(sine, 2.0**-53))


def _shifted(scene: Scene) -> Scene:
    """Translate by about three quarters of the distance from eye to target."""
    reach = 2.0 ** np.round(np.log2(np.linalg.norm(scene.target - scene.eye)))
    return translated(scene, [0.6 * reach, -0.4 * reach, 0.3 * reach])


_CYCLE = rotation(1, 1, 1, 1)
_TURN = rotation(9, 2, -3, 5)

#: Every relation, those first that need no rounding. `axes` sends x to y, y to z and z to x.
RELATIONS = (
    Relation("scale-1024", lambda s: scaled(s, 1024), 1024, exact=True, rounds=False),
    Relation("scale-1/64", lambda s: scaled(s, 1 / 64), 1 / 64, exact=True, rounds=False),
    Relation("order", reordered, moves=False, exact=True, rounds=False, ties=True),
    Relation("channels", lambda s: recolored(s, (1, 2, 0)), channels=(1, 2, 0), moves=False,
             exact=True, rounds=False),
    Relation("split-lights", light_split, moves=False, exact=True),
    Relation("axes", lambda s: turned(s, _CYCLE), exact=True),
    Relation("scale-3", lambda s: scaled(s, 3), 3),
    Relation("translate", _shifted),
    Relation("rotate", lambda s: turned(s, _TURN)),
)  # fmt: skip


def _times(value: float, by: Fraction) -> float:
    return float(Fraction(value) * by)


def _each(rows: Array, move: Callable[[Vector], Vector]) -> Array:
    """Apply an exact map to rows of three numbers, and round once."""
    moved = [[float(v) for v in move((Fraction(x), Fraction(y), Fraction(z)))]
             for x, y, z in rows.tolist()]  # fmt: skip
    return np.array(moved, np.float64).reshape(-1, 3)


def _places(scene: Scene, move: Callable[[Vector], Vector]) -> Array:
    geometry = scene.geometry.copy()
    geometry[:, :3] = _each(scene.geometry[:, :3], move)
    return geometry


def _moved(scene: Scene, move: Callable[[Vector], Vector], **changes: object) -> Scene:
    """Return the scene with eye, target and lights moved, and other fields as given."""
    lights = scene.lights.copy()
    lights[:, 3:] = _each(scene.lights[:, 3:], move)
    eye, target = _each(np.stack([scene.eye, scene.target]), move)
    fields = {"eye": eye, "target": target, "lights": lights, "checked": False, **changes}
    return replace(scene, **fields)
