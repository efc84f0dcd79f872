"""What a judged scene leaves in the report for its page: its objects, its pixels, its excesses."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from crosstrace.harness import images, maps, record, witnesses
from crosstrace.harness.classes import Class, Classified
from crosstrace.harness.lanes import REFERENCE, loaded
from crosstrace.harness.spread import spread
from crosstrace.harness.store import Place
from crosstrace.translators.renderer import RenderOptions
from crosstrace.translators.scene import Scene

if TYPE_CHECKING:
    from crosstrace.harness.judging import Judgement

Array = NDArray[np.float64]


def files(
    scene: Scene,
    lanes: Mapping[str, Array],
    judged: Judgement,
    far: Mapping[str, Array],
    readings: Mapping[str, str],
    threads: int,
    common: Place,
) -> dict[str, dict[str, str]]:
    """Write the map of objects and the pixels to show; return their records."""
    options = RenderOptions(threads=threads, readings=dict(readings), layers=True)
    objects = loaded(REFERENCE).render(scene, options).layers["object"]
    maps.write(common.file(".objects.npz"), {"object": objects.astype(np.int32)})
    pixels = witnesses.record(scene, lanes, judged, far, readings, threads)
    images.write_bytes(common.file(".pixels.json"), record.dumps(pixels).encode())
    return {"objects": common.entry(".objects.npz"), "pixels": common.entry(".pixels.json")}


def excess(classified: Classified, far: Array) -> dict[str, dict[str, Any]]:
    """Say how far the pixels of each class lie beyond what counts as equal, see `spread`."""
    beyond = np.maximum(far - classified.tolerance, 0.0)
    return {
        kind.name.lower(): spread(beyond[classified.classes == kind])
        for kind in Class
        if kind != Class.EQUAL and (classified.classes == kind).any()
    }
