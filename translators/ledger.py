"""The fidelity ledger: what a renderer does otherwise than the specification, said beforehand.

A declaration is believed only where it is proven: where a lane's value departs from the truth, the
truth under the lane's own habits (`Emulation`) must enclose it. What no reading of the native
tracer can reproduce stands in the ledger as an entry without readings, and is proven by the ray
tree of the pixel, which must meet one of the entry's objects.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Literal

if TYPE_CHECKING:
    from crosstrace.translators.scene import Scene

Fidelity = Literal["exact", "approximated", "unsupported"]


@dataclass(frozen=True)
class Entry:
    """One declaration of a translator about one scene.

    `effect` is a name of `effects.py` or ``geometry``, ``camera``, ``output``, ``arithmetic``;
    `situation` says in words where it applies; `bound` is the greatest error on linear float where
    one is known; `objects` are the indices concerned (empty: the whole image); `readings` are the
    names of the emulation's readings that reproduce it, or ``scene`` where its numbers do (empty:
    nothing does). Only hits at least `beyond` world units away are concerned.
    """

    effect: str
    situation: str
    fidelity: Fidelity
    bound: float | None = None
    objects: tuple[int, ...] = ()
    readings: tuple[str, ...] = ()
    beyond: float = 0.0


@dataclass(frozen=True)
class Arithmetic:
    """The rounding errors of a renderer, relative.

    `unit` is that of one operation of its geometry (2⁻²⁴, 2⁻⁵³) and `color_unit` that of its
    colours; `kappa`, which is measured, says how many units its directions and hits carry.
    """

    unit: float
    kappa: float
    color_unit: float

    @property
    def error(self) -> float:
        """The relative error of directions and hits."""
        return self.kappa * self.unit


@dataclass(frozen=True)
class Emulation:
    """What the native tracer has to trace to have a renderer's habits: its scene, its readings."""

    scene: Scene
    readings: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class Ledger:
    """All that a renderer declares about one scene; iterates over the entries.

    `emulation` None: the renderer follows the specification but for its arithmetic.
    """

    entries: tuple[Entry, ...]
    arithmetic: Arithmetic
    emulation: Emulation | None = None

    def __iter__(self) -> Iterator[Entry]:
        """Iterate over the entries."""
        return iter(self.entries)

    def __len__(self) -> int:
        """Return the number of entries."""
        return len(self.entries)
