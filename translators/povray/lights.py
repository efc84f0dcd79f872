"""On which side of a surface each light stands, and how POV-Ray is brought to the literal formula.

The specification's diffuse term is max(0, n·l) with the normal as given, its highlight does not ask
for n·l. POV-Ray flips the normal to the viewer and drops lights behind it, highlight and all;
`double_illuminate` removes that test and makes the diffuse term \\|n·l\\|. A point light is either on
the outer side of a whole surface (outside the sphere, before the plane) or on its inner side:

| lights | diffuse and highlight wanted | what is written |
|---|---|---|
| all outer | any | `double_illuminate` where the inner side can be seen: a sphere shadows its own far half, a plane has n·l > 0 everywhere |
| all inner | any | no diffuse, `double_illuminate` |
| both | diffuse alone | a light group of the outer ones |
| both | highlight alone | no diffuse, `double_illuminate` |
| both | both | a light group of all lights, and for each inner one a pair of fill lights that takes its diffuse term away again: −C everywhere, +C where something blocks (`projected_through`); fill lights give no highlight |
"""  # noqa: E501 - a table is read by its rows

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from crosstrace.translators.errors import UnsupportedSceneError
from crosstrace.translators.povray.camera import CameraSide
from crosstrace.translators.povray.plan import Plan
from crosstrace.translators.scene import KD, KS, KT

#: A blocker list stands in the file once for every pair of fill lights; beyond this POV-Ray chokes.
_MAX_BLOCKER_COPIES = 2_000_000


@dataclass(frozen=True)
class Lighting:
    """How each surface (n) is lit by each light (m).

    `inner` (n, m): the light stands on the inner side. `group` (n,): the surface needs a light
    group of its own. `fill` (n,): with fill lights. `diffuse` (n,): the finish has a diffuse term.
    `double` (n,): `double_illuminate`.
    """

    inner: NDArray[np.bool_]
    group: NDArray[np.bool_]
    fill: NDArray[np.bool_]
    diffuse: NDArray[np.bool_]
    double: NDArray[np.bool_]


def lighting(plan: Plan, side: CameraSide) -> Lighting:
    """Classify the lights; raises UnsupportedSceneError where the file would grow beyond use."""
    inner = _inner(plan)
    any_inner, all_inner = inner.any(axis=1), inner.all(axis=1) & (len(plan.lights) > 0)
    shines, gleams = plan.material[:, KD] > 0, plan.material[:, KS] > 0
    mixed = any_inner & ~all_inner & shines
    diffuse = shines & ~all_inner
    seen_from_inside = (plan.material[:, KT] > 0) | side.inside | side.on
    # Without shadows the far half of a sphere keeps its highlight.
    double = seen_from_inside | (any_inner & gleams) | (gleams & (not plan.shadows))
    if not plan.shadows and (plan.sphere & double & diffuse & ~inner.all(axis=1)).any():
        raise UnsupportedSceneError(
            "POV-Ray cannot leave out shadows alone: expected them wherever both sides of a sphere "
            "are lit, or both diffuse and specular are asked for"
        )
    fill = mixed & gleams
    copies = int(inner[fill].sum()) * len(plan)
    if copies > _MAX_BLOCKER_COPIES:
        raise UnsupportedSceneError(
            f"POV-Ray needs {copies} copies of objects to light surfaces from both sides, "
            f"expected at most {_MAX_BLOCKER_COPIES}"
        )
    return Lighting(
        inner=inner,
        group=mixed,
        fill=fill,
        diffuse=diffuse,
        double=double,
    )


def _inner(plan: Plan) -> NDArray[np.bool_]:
    inner = np.zeros((len(plan), len(plan.lights)), bool)
    position, normal = plan.geometry[:, :3], plan.geometry[:, 3:]
    for j, light in enumerate(plan.lights):
        offset = light[3:] - position
        ball = np.linalg.norm(offset, axis=1) <= plan.geometry[:, 3]
        inner[:, j] = np.where(plan.sphere, ball, (offset * normal).sum(axis=1) <= 0)
    return inner
