"""POV-Ray's own habits as a scene and readings of the native tracer.

With its limits of distance (`scale.py`) as readings, the indices that it is given (`media.py`) as
absolute ones, and its list of interiors (`nesting=interiors`, after ComputeRefraction in its
trace.cpp), the native tracer follows the paths that POV-Ray follows, so that crossing transparent
surfaces come out alike as well.

POV-Ray starts a secondary ray at the hit itself and takes nothing nearer than MIN_DISTANCE; in real
arithmetic that is a ray that starts MIN_DISTANCE along its direction. A shadow ray's tolerance is
larger, and counts at the light too.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from crosstrace.translators.ledger import Emulation
from crosstrace.translators.povray.picture import Analysis
from crosstrace.translators.povray.scale import MAX_DISTANCE, MIN_DISTANCE, SHADOW_TOLERANCE
from crosstrace.translators.scene import KT, N


def emulation(analysis: Analysis) -> Emulation:
    """Return the scene and the readings that have POV-Ray's habits in an analysed scene."""
    scale, scene = analysis.scale, analysis.plan.scene
    readings = {
        "epsilon": repr(MIN_DISTANCE / scale),
        "shadow_min": repr((SHADOW_TOLERANCE - MIN_DISTANCE) / scale),
        "light_min": repr(SHADOW_TOLERANCE / scale),
        "far": repr(MAX_DISTANCE / scale),
        "nesting": "interiors",
    }
    material = scene.material.copy()
    material[analysis.plan.index, N] = _absolute(analysis)
    return Emulation(replace(scene, material=material, checked=False), readings)


def _absolute(analysis: Analysis) -> NDArray[np.float64]:
    """Return every surface's index relative to the world, where POV-Ray's are to the camera's.

    A surface that holds the camera has the camera's side as its inside; the index that POV-Ray
    knows of it is that of its outer side.
    """
    plan, inside = analysis.plan, analysis.side.inside
    ior = analysis.media.ior.astype(np.float64)
    transparent = plan.material[:, KT] > 0
    around = np.flatnonzero(transparent & inside)
    # From the outermost inwards: planes hold every sphere that holds the camera or crosses it.
    extent = np.where(plan.sphere, plan.geometry[:, 3], np.inf)
    around = around[np.argsort(-extent[around], kind="stable")]
    camera = 1.0 / ior[around[0]] if len(around) else 1.0
    absolute = np.where(transparent, ior * camera, plan.scene.material[plan.index, N])
    absolute[around] = camera
    absolute[around[:-1]] *= ior[around[1:]]
    return absolute
