"""Conditioning: is a value that differs from truth wrong, or what rounding makes of it?

Two models of a renderer's arithmetic, both under any reading (section 5 of the design):

- the *sampled envelope* (`envelope.py`) has the power: its boxes are narrow even behind glass;
- the *inflated enclosure*, intervals widened by the error everywhere (`certify` with kappa), has
  the proof: outside it a value is wrong. Behind several layers of glass it says little.

`unexplained.py` says how much of each is spent on an image.
"""

from __future__ import annotations

from collections.abc import Mapping
from enum import IntEnum
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crosstrace.translators.ledger import Arithmetic, Emulation
from crosstrace.translators.native.envelope import Envelope, Floats, envelope
from crosstrace.translators.native.unexplained import Unexplained
from crosstrace.translators.scene import Scene

__all__ = ["Arithmetic", "Conditioned", "Envelope", "envelope", "judge"]


class Conditioned(IntEnum):
    """What a value is, given the arithmetic that made it."""

    EXPLAINED = 0
    SUSPECT = 1
    WRONG = 2


def judge(
    scene: Scene,
    values: Floats,
    *,
    pixels: NDArray[np.integer[Any]],
    arithmetic: Arithmetic,
    readings: Mapping[str, str] | None = None,
    slack: float | Floats = 0.0,
    threads: int = 0,
) -> NDArray[np.uint8]:
    """Say of each foreign value (n, 3) of `pixels` (n,) what it is: (n,) of `Conditioned`.

    EXPLAINED: inside the sampled envelope, of more and more samples for the pixels that are left.
    WRONG: outside the inflated enclosure, whatever rounding did. SUSPECT: between. `slack`, a
    number or (n,), is what the output's quantisation may add. Meant for the pixels over tolerance
    of one image.

    Raises UsageError for a reading that does not exist or offset=bound, RendererError where the
    ray budget is used up.
    """
    pixels = np.ravel(pixels)
    values = np.asarray(values, np.float64).reshape(-1, 3)
    room = np.broadcast_to(np.asarray(slack, np.float64), pixels.shape)
    left = Unexplained(pixels, values, room, arithmetic, threads)
    meaning = Emulation(scene, dict(readings or {}))
    answer = np.full(len(pixels), Conditioned.WRONG, np.uint8)
    left.drop_impossible([meaning])
    answer[left.take_rounded(meaning)] = Conditioned.EXPLAINED
    answer[left.take_possible([meaning])] = Conditioned.SUSPECT
    return answer
