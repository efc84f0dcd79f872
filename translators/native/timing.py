"""Frames of the native tracer, timed, into memory that the caller has."""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crosstrace.native import _core
from crosstrace.translators.effects import effects
from crosstrace.translators.native.truth import TOLERANCE, room
from crosstrace.translators.renderer import RAY_KINDS
from crosstrace.translators.scene import Scene


@dataclass(frozen=True)
class Timed:
    """Seconds by the clock and of the processor, all threads together, and the rays traced."""

    wall_s: float
    processor_s: float
    n_rays: int = 0


def frame(
    scene: Scene, image: NDArray[np.float64], threads: int = 1, instructions: str = "native"
) -> Timed:
    """Render in double into an image (v_res, h_res, 3), with the effects that are called for."""
    settings = [*_settings(scene, threads), ("instructions", instructions)]
    began = _now()
    found = _core.render(scene.native_view(), settings, {"image": image}, None)
    wall, processor = _now()
    return Timed(wall - began[0], processor - began[1], sum(found[kind] for kind in RAY_KINDS))


def room_for_enclosures(scene: Scene) -> dict[str, NDArray[Any]]:
    """Return the arrays of a whole frame's enclosures, written to once."""
    arrays = room((scene.v_res, scene.h_res))
    for array in arrays.values():
        array.fill(0)
    return arrays


def certified_frame(scene: Scene, arrays: dict[str, NDArray[Any]]) -> Timed:
    """Enclose every pixel on one thread, in all the arithmetics that it takes, into the arrays."""
    settings = _settings(scene, threads=1)
    began = _now()
    _core.certify(scene.native_view(), settings, None, TOLERANCE, 0.0, arrays, None)
    wall, processor = _now()
    return Timed(wall - began[0], processor - began[1])


def _settings(scene: Scene, threads: int) -> list[tuple[str, str]]:
    return [("threads", str(threads)), ("effects", str(effects(scene).overall))]


def _now() -> tuple[float, float]:
    return time.perf_counter(), time.process_time()
