"""The fidelity ledger: what a renderer does otherwise than the specification, said beforehand."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

Fidelity = Literal["exact", "approximated", "unsupported"]


@dataclass(frozen=True)
class Entry:
    """One declaration of a translator about one scene.

    `effect` is a name of `effects.py` or ``geometry``, ``camera``, ``output``, ``arithmetic``;
    `situation` says in words where it applies; `bound` is the greatest error on linear float where
    one is known; `objects` are the indices concerned (empty: the whole image).
    """

    effect: str
    situation: str
    fidelity: Fidelity
    bound: float | None = None
    objects: tuple[int, ...] = ()


@dataclass(frozen=True)
class Arithmetic:
    """How a renderer rounds, as far as its values show it.

    `unit` is the relative error of one operation on lengths and directions (2⁻²⁴ for float32, 2⁻⁵³
    for double), `kappa` how many units its directions and hits carry, measured and not guessed,
    `color_unit` the unit of its colours: POV-Ray intersects in double and keeps colours in float32.
    """

    unit: float
    kappa: float
    color_unit: float

    @property
    def error(self) -> float:
        """The relative error of directions and hits."""
        return self.kappa * self.unit
