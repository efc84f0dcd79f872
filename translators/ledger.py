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
