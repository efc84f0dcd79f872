"""Delivery 1 through Mitsuba alone: its `aov` integrator says which shape each pixel sees."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from crosstrace.translators.scene import Scene


def image(scene: Scene, rendered: Any, mitsuba_scene: Any, mi: Any) -> NDArray[np.float64]:
    """Colour the shape numbers of the stock document's `object` channel, (v_res, h_res, 3).

    The numbers are those of Mitsuba's registry, whose order changes from run to run: the ids tell
    which object each belongs to. The colours are the scene's own, in float64.
    """
    import drjit as dr

    seen = np.asarray(rendered)[:, :, 3].astype(np.int64)
    colors = np.full((int(seen.max()) + 1, 3), np.nan)
    for shape in mitsuba_scene.shapes():
        number = int(dr.reinterpret_array(mi.UInt32, mi.ShapePtr(shape))[0])
        if number < len(colors):
            colors[number] = _color(scene, shape.id())
    result: NDArray[np.float64] = colors[seen]
    return result


def _color(scene: Scene, name: str) -> Any:
    if name == "background":
        return scene.background / 255
    return scene.color[int(name.rpartition("_")[2])] / 255
