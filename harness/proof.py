"""Proof that leaving effects out changes no image, and what it saves: gated against ungated.

Each lane renders a scene as it always does (gated: what the scene calls for), with all effects of
its delivery (ungated), without each effect that is called for, and with each that is left out. A
first round warms caches and counts only for the images; the others are interleaved, and times are
medians. The images have to be the same to the last bit, or for a lane with quantised output the
same within its steps.
"""

from __future__ import annotations

import statistics
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from crosstrace.harness import alone
from crosstrace.translators.effects import EFFECTS, effects, of_delivery
from crosstrace.translators.errors import CrosstraceError, RendererError, UnsupportedSceneError
from crosstrace.translators.renderer import Rendering, RenderOptions
from crosstrace.translators.scene import Scene

GATED, UNGATED = "gated", "ungated"

#: Called with a lane and the part of its work that is done.
Told = Callable[[str, float], None]


@dataclass
class _Variant:
    effects: frozenset[str] | None
    made: Rendering | None = None
    seconds: list[float] = field(default_factory=list)
    reason: str = ""

    @property
    def median(self) -> float | None:
        return statistics.median(self.seconds) if self.seconds else None


def prove(
    scene: Scene, lanes: Sequence[str], how: RenderOptions, repeat: int, told: Told
) -> list[dict[str, Any]]:
    """Return a record of each lane, JSON-ready.

    `status` is "ok", or "missing", "unsupported" or "failed" with a `message`, and then there is
    nothing else. `identical` says that gated and ungated images have the same bits, `equal` that
    they are as the module's text demands, `max_difference` by how much they differ. `seconds` are
    medians of gated and ungated, `runs` all of them, `saved_seconds` their difference;
    `cost_seconds` and `left_out_seconds` say by effect what it costs, and would cost; None where
    the lane cannot leave it out or take it in alone.
    """
    return [_lane(lane, scene, how, repeat, told) for lane in lanes]


def _lane(lane: str, scene: Scene, how: RenderOptions, repeat: int, told: Told) -> dict[str, Any]:
    called_for = frozenset(effects(scene).names)
    everything = of_delivery(scene.delivery)
    variants = {GATED: _Variant(None), UNGATED: _Variant(everything)}
    for name in EFFECTS:
        if name in called_for:
            variants[name] = _Variant(called_for - {name})
        elif name in everything:
            variants[name] = _Variant(called_for | {name})
    try:
        found = alone.probe(lane)
        if not found.available:
            return {"name": lane, "status": "missing", "message": found.reason}
        total, done = len(variants) * (repeat + 1), 0
        for turn in range(repeat + 1):
            for key, variant in variants.items():
                _render(lane, scene, how, variant, key in (GATED, UNGATED), turn > 0)
                done += 1
                told(lane, done / total)
    except UnsupportedSceneError as error:
        return {"name": lane, "status": "unsupported", "message": str(error)}
    except RendererError as error:
        return {"name": lane, "status": "failed", "message": str(error)}
    return {"name": lane, "status": "ok", **_record(variants, called_for)}


def _render(
    lane: str, scene: Scene, how: RenderOptions, variant: _Variant, must: bool, counts: bool
) -> None:
    if variant.reason:
        return
    try:
        made, _ = alone.render(lane, scene, replace(how, effects=variant.effects))
    except CrosstraceError as error:
        if must:
            raise
        variant.reason = str(error)
        return
    if variant.made is None and must:
        variant.made = made
    if counts:
        variant.seconds.append(made.seconds.render)


def _record(variants: dict[str, _Variant], called_for: frozenset[str]) -> dict[str, Any]:
    gated, ungated = variants[GATED], variants[UNGATED]
    assert gated.made is not None and ungated.made is not None
    difference = float(np.abs(gated.made.image - ungated.made.image).max(initial=0.0))
    steps = gated.made.half_step + ungated.made.half_step
    identical = gated.made.image.tobytes() == ungated.made.image.tobytes()
    base = gated.median
    extra = {
        name: None if base is None or it.median is None else it.median - base
        for name, it in variants.items()
        if name not in (GATED, UNGATED)
    }
    return {
        "identical": identical,
        "equal": identical or (steps > 0 and difference <= steps),
        "max_difference": difference,
        "half_steps": steps,
        "seconds": {GATED: base, UNGATED: ungated.median},
        "runs": {GATED: gated.seconds, UNGATED: ungated.seconds},
        "saved_seconds": _minus(ungated.median, base),
        "cost_seconds": {n: None if s is None else -s for n, s in extra.items() if n in called_for},
        "left_out_seconds": {n: s for n, s in extra.items() if n not in called_for},
        "not_alone": {name: it.reason for name, it in variants.items() if it.reason},
    }


def _minus(a: float | None, b: float | None) -> float | None:
    return None if a is None or b is None else a - b
