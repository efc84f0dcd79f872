"""How far the native tracer's numbers can be trusted on one scene.

The scene is rendered in every scalar type of this platform (the *rungs*) and compared with truth:
the widest rung's value, where the certified kernel encloses the pixel to 1e-9. Beside that: which
pixels are undecidable and why, what the rounding mode changes, and what another epsilon would.

A pixel is *decidable* where it is certified. A rung's ray tree is *changed* where its decisions
(`tree`, adapter.py) differ from the widest rung's. The certified kernel escalates from double to
double-double to float128 intervals; `by_level` counts the changed trees of decidable pixels by the
type that was needed, because a decision whose margin double intervals cannot tell from zero is one
that no double rung can be asked to make.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crosstrace.native import _core
from crosstrace.translators.native.adapter import Native
from crosstrace.translators.native.digits import DIGITS, digits_lost
from crosstrace.translators.native.truth import Decision, Enclosures, PixelClass, certify
from crosstrace.translators.renderer import Rendering, RenderOptions
from crosstrace.translators.scene import Scene

Array = NDArray[np.float64]

#: What `epsilon` is tried at, and the rungs that try it: the common types of renderers.
EPSILONS = tuple(f"1e-{k}" for k in range(1, 14))
EPSILON_RUNGS = ("f32", "f64")

#: A difference that can be seen: half a level of an 8-bit image.
VISIBLE = 1 / 510

#: Quantiles of an error; `max` stands beside them.
QUANTILES = {"median": 0.5, "p99": 0.99, "p999": 0.999}


@dataclass(frozen=True)
class Rung:
    """One scalar type against truth.

    `changed_trees` counts pixels with another ray tree than the widest rung's, `changed_decidable`
    those of them that are decidable, and `by_level` splits these by the type of intervals that was
    needed (double, double-double, float128). `error_map` (v_res, h_res) is the greatest difference
    of a channel from truth, NaN in undecidable pixels; for the widest rung itself it is the
    distance from the enclosure, 0 inside. `error` holds its quantiles over the decidable pixels
    (None for none), `error_same_tree` its maximum where the tree is unchanged.
    """

    precision: str
    seconds: float
    changed_trees: int
    changed_decidable: int
    by_level: tuple[int, int, int]
    error: dict[str, float | None]
    error_same_tree: float | None
    error_map: Array


@dataclass(frozen=True)
class Reason:
    """Undecidable pixels with one first open decision: which, about which object, how deep.

    `object` −1: none in particular. `pixel` is the first of them, (row, column).
    """

    pixel_class: str
    decision: str
    object: int
    depth: int
    count: int
    pixel: tuple[int, int]


@dataclass(frozen=True)
class EpsilonChange:
    """What a rung shows at an epsilon, against the widest rung at the default 1e-5."""

    epsilon: float
    visible: int
    max: float


@dataclass(frozen=True)
class Stability:
    """Everything that was measured of one scene; rungs are narrowest first.

    `digits` maps the rungs that run in any rounding mode to the bits lost per pixel (digits.py).
    `epsilons` maps `EPSILON_RUNGS` to one entry for each of `EPSILONS`.
    """

    known: Enclosures
    rungs: tuple[Rung, ...]
    reasons: tuple[Reason, ...]
    digits: dict[str, Array]
    epsilons: dict[str, tuple[EpsilonChange, ...]]


def measure(scene: Scene, *, threads: int = 0) -> Stability:
    """Measure a scene in every rung; float128 takes some 70 times as long as double.

    Raises RendererError where the ray budget is used up.
    """
    known, truth, rungs = _ladder(scene, _core.precisions(), threads)
    digits = {name: digits_lost(scene, name) for name in DIGITS if name in _core.precisions()}
    epsilons = {
        name: tuple(_at_epsilon(scene, name, text, truth.image, threads) for text in EPSILONS)
        for name in EPSILON_RUNGS
    }
    return Stability(known, rungs, _reasons(known), digits, epsilons)


def compare_rungs(
    scene: Scene, precisions: Sequence[str] | None = None, *, threads: int = 0
) -> tuple[Enclosures, tuple[Rung, ...]]:
    """Certify, and measure some rungs (None: all) and the widest, without what else `measure` does.

    Raises UsageError for a precision that this platform lacks.
    """
    wanted = _core.precisions() if precisions is None else list(precisions)
    known, _, rungs = _ladder(scene, wanted, threads)
    return known, rungs


def summary(found: Stability) -> dict[str, Any]:
    """Return what is JSON-ready of it, by the stable names of the command's output."""
    return {
        "certified_fraction": found.known.certified_fraction,
        "undecidable": int(found.known.undecidable.sum()),
        "widest_enclosure": _maximum((found.known.hi - found.known.lo)[~found.known.undecidable]),
        "certified_by": dict(found.known.closed),
        "reasons": [
            {"class": r.pixel_class, "decision": r.decision, "object": r.object, "depth": r.depth,
             "count": r.count, "pixel": list(r.pixel)}
            for r in found.reasons
        ],
        "rungs": [
            {"precision": r.precision, "changed_trees": r.changed_trees,
             "changed_decidable": r.changed_decidable, "changed_by_level": list(r.by_level),
             "error": r.error, "error_same_tree": r.error_same_tree, "seconds": r.seconds}
            for r in found.rungs
        ],
        "digits_lost": {name: quantiles(lost.ravel()) for name, lost in found.digits.items()},
        "epsilon": {
            name: [{"epsilon": e.epsilon, "visible": e.visible, "max": e.max} for e in changes]
            for name, changes in found.epsilons.items()
        },
    }  # fmt: skip


def quantiles(values: Array) -> dict[str, float | None]:
    """Return the quantiles and the maximum of some numbers ≥ 0; None for each of no numbers."""
    if not values.size:
        return dict.fromkeys([*QUANTILES, "max"])
    # Values that occur, not interpolated: between 0 and a wrong edge nothing was ever measured.
    at = np.quantile(values, list(QUANTILES.values()), method="higher")
    return {**dict(zip(QUANTILES, map(float, at), strict=True)), "max": float(values.max())}


def _ladder(
    scene: Scene, precisions: Sequence[str], threads: int
) -> tuple[Enclosures, Rendering, tuple[Rung, ...]]:
    known = certify(scene, threads=threads)
    widest = _core.precisions()[-1]
    truth = _render(scene, widest, threads)
    rungs = [
        _rung(name, _render(scene, name, threads), truth, known)
        for name in precisions
        if name != widest
    ]
    return known, truth, (*rungs, _rung(widest, truth, truth, known))


def _render(
    scene: Scene, precision: str, threads: int, readings: Mapping[str, str] | None = None
) -> Rendering:
    options = RenderOptions(threads, readings or {}, precision, layers=True)
    return Native().render(scene, options)


def _rung(name: str, made: Rendering, truth: Rendering, known: Enclosures) -> Rung:
    decidable = ~known.undecidable
    changed = made.layers["tree"] != truth.layers["tree"]
    if made is truth:
        outside = np.maximum(known.lo - made.image, made.image - known.hi)
        error = np.maximum(outside, 0.0).max(axis=-1)
    else:
        # Both parts of both numbers: rounding to double would hide what wide types have left.
        low = made.layers.get("image_low", np.zeros(())) - truth.layers.get("image_low", 0.0)
        error = np.abs((made.image - truth.image) + low).max(axis=-1)
    levels = np.bincount(known.level[changed & decidable], minlength=3)
    return Rung(
        precision=name,
        seconds=made.seconds.render,
        changed_trees=int(changed.sum()),
        changed_decidable=int((changed & decidable).sum()),
        by_level=(int(levels[0]), int(levels[1]), int(levels[2])),
        error=quantiles(error[decidable]),
        error_same_tree=_maximum(error[decidable & ~changed]),
        error_map=np.where(decidable, error, np.nan),
    )


def _maximum(values: Array) -> float | None:
    return float(values.max()) if values.size else None


def _reasons(known: Enclosures) -> tuple[Reason, ...]:
    """Group the undecidable pixels by their first open decision, most frequent first."""
    where = np.argwhere(known.undecidable)
    if not len(where):
        return ()
    rows, columns = where.T
    keys = np.stack(
        [part[rows, columns].astype(np.int64)
         for part in (known.pixel_class, known.decision, known.object, known.depth)], axis=1,
    )  # fmt: skip
    kinds, first, count = np.unique(keys, axis=0, return_index=True, return_counts=True)
    found = [
        Reason(
            PixelClass(kind[0]).name.lower(), Decision(kind[1]).name.lower(), int(kind[2]),
            int(kind[3]), int(n), (int(rows[i]), int(columns[i])),
        )
        for kind, i, n in zip(kinds.tolist(), first, count, strict=True)
    ]  # fmt: skip
    return tuple(sorted(found, key=lambda reason: -reason.count))


def _at_epsilon(
    scene: Scene, precision: str, epsilon: str, truth: Array, threads: int
) -> EpsilonChange:
    image = _render(scene, precision, threads, {"epsilon": epsilon}).image
    apart = np.abs(image - truth).max(axis=-1)
    return EpsilonChange(float(epsilon), int((apart > VISIBLE).sum()), float(apart.max()))
