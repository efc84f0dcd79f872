"""The two scales of a POV-Ray rendering: of the world, and of the output.

POV-Ray's tolerances are constants of world units (`trace.cpp`, `configbackend.h` of 3.7): a shadow
ray ignores what is nearer than 1e-3, any other ray what is nearer than 1e-4, and nothing farther
than 1e7 is hit. Everything is multiplied by a power of two, which changes no digit, so that they
fall where they harm least.

Its 16-bit output ends at 1. Everything is linear in the lights, the ambient light and the
background, so these are divided by a scale K and the image is multiplied by it again (`output.py`).
"""

from __future__ import annotations

import numpy as np

from crosstrace.translators.povray.lights import Lighting
from crosstrace.translators.povray.plan import Array, Plan
from crosstrace.translators.scene import KA, KD, KR, KS, KT, N

SHADOW_TOLERANCE = 1e-3
MIN_DISTANCE = 1e-4
MAX_DISTANCE = 1e7

#: Puts the shadow tolerance just below the specification's ε of 1e-5.
_MAX_SCALE = 128.0

#: The height over planes, in scaled units, that was best in a sweep over random rooms: a larger one
#: ends the planes before their horizon, a smaller one swallows contact shadows.
_HEIGHT = 50.0

#: So many positions are enough to find a median height.
_SAMPLE = 1000


def world_scale(plan: Plan) -> float:
    """Return the factor from world units to POV-Ray's, a power of two, at most 128."""
    geometry, eye = plan.geometry, plan.scene.eye
    balls = geometry[plan.sphere]
    reach = np.linalg.norm(balls[:, :3] - eye, axis=1) + balls[:, 3]
    # No hit of a finite object may lie beyond the limit: across the scene and back again.
    largest = min(_MAX_SCALE, MAX_DISTANCE / (4 * max(reach.max(initial=0.0), 1e-300)))
    planes = geometry[~plan.sphere]
    if len(planes):
        places = np.concatenate([eye[None], balls[:: max(1, len(balls) // _SAMPLE), :3]])
        farthest = np.zeros(len(places))
        for row in planes:
            np.maximum(farthest, np.abs((places - row[:3]) @ row[3:]), out=farthest)
        if (height := float(np.median(farthest))) > 0:
            return float(
                2.0 ** np.floor(min(np.log2(largest), np.round(np.log2(_HEIGHT / height))))
            )
    return float(2.0 ** np.floor(np.log2(largest)))


def value_bound(plan: Plan, lighting: Lighting) -> float:
    """Return a number that no pixel of the image exceeds, from the scene alone.

    Every light that a surface's outer side faces is taken as unblocked and head-on, every surface
    as seen by every secondary ray.
    """
    local = plan.material[:, KA, None] * plan.color * plan.ambient
    for j, light in enumerate(plan.lights):
        shine = np.where(lighting.inner[:, j], 0.0, diffuse_share(plan, lighting))
        local = local + (shine[:, None] * plan.color + plan.material[:, KS, None]) * light[:3]
    own = local.max(axis=1, initial=0.0)
    # Surfaces that pass on the same share differ by their own light only.
    share, which = np.unique(throughput(plan.material), return_inverse=True)
    most = np.zeros(len(share))
    np.maximum.at(most, which, own)
    background = float(plan.scene.background.max()) / 255
    bound = max(background, float(most.max(initial=0.0)))
    for _ in range(plan.depth):
        bound = max(bound, float((most + share * bound).max(initial=0.0)))
    return bound


def throughput(material: Array) -> Array:
    """Return the greatest share of its secondary rays that each surface passes on, (n,)."""
    total = np.where((material[:, KT] > 0) & (material[:, N] != 1.0), 1.0, 0.0)
    return np.maximum(material[:, KR] + material[:, KT], total)


def diffuse_share(plan: Plan, lighting: Lighting) -> Array:
    """Return the diffuse coefficient of each surface as it is written, (n,)."""
    return np.where(lighting.diffuse, plan.material[:, KD], 0.0)
