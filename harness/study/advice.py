"""One sentence of advice: the cheapest setting that is exact enough, or the most exact in time."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from crosstrace.harness.study.errors import METRICS
from crosstrace.harness.study.points import KINDS
from crosstrace.translators.native.stability import VISIBLE

#: Kinds whose errors are all distances from the certified value, so that one may be weighed against
#: another: whatever caused it, the pixel is that far from the truth.
FROM_TRUTH = ("rounding", "model", "offset", "pruning")

#: Where nobody says what is wanted: half a level of an 8-bit image.
DEFAULT_WANT = VISIBLE

_AGAINST = {
    "certified": "the certified value", "deep": "the deep render",
    "average": "the converged average",
}  # fmt: skip

#: A share of the time.
_MOST_SPREAD = 0.2

_ARTICLE = {"max": "a", "rmse": "an", "p999": "a"}


@dataclass(frozen=True)
class Wish:
    """An error that may be had at most, or a time in seconds (then `want` is None).

    `kind` None: anything that is measured against the certified value.
    """

    want: float | None = DEFAULT_WANT
    budget_s: float | None = None
    metric: str = "rmse"
    kind: str | None = None


@dataclass(frozen=True)
class Advice:
    """A sentence, and the point that it names (an index; None: none fulfils the wish)."""

    sentence: str
    point: int | None


def advise(points: Sequence[Mapping[str, Any]], wish: Wish) -> Advice:
    """Choose among the records of points; see `experiment.py` for their keys."""
    kinds = FROM_TRUTH if wish.kind is None else (wish.kind,)
    known = [
        i
        for i, point in enumerate(points)
        if point["kind"] in kinds
        and point["error"][wish.metric] is not None
        # What is measured against a renderer's own rules says nothing about the truth.
        and not point["own_rules"]
    ]
    if not known:
        return Advice("No setting was measured that could be advised.", None)

    def error(i: int) -> float:
        return float(points[i]["error"][wish.metric])

    def seconds(i: int) -> float:
        return float(points[i]["seconds"])

    against = _AGAINST[points[known[0]]["against"]]
    metric = METRICS[wish.metric]
    if wish.budget_s is not None:
        aim = f"Within {_time(wish.budget_s)}"
        fitting = [i for i in known if seconds(i) <= wish.budget_s]
        best = min(fitting, key=lambda i: (error(i), seconds(i)), default=None)
        nearest = min(known, key=lambda i: (seconds(i), error(i)))
        praise = "the most exact"
    else:
        assert wish.want is not None
        want = wish.want
        aim = f"For {_ARTICLE[wish.metric]} {metric} of at most {want:.3g} against {against}"
        fitting = [i for i in known if error(i) <= want]
        best = _cheapest(points, fitting)
        nearest = min(known, key=lambda i: (error(i), seconds(i)))
        praise = "the cheapest"
    chosen = nearest if best is None else best
    point = points[chosen]
    facts = f"{_time(seconds(chosen))}, {metric} {error(chosen):.2g} against {against}"
    line = f"run `{point['command']}`"
    if best is None:
        text = f"{aim} no measured setting will do; {_name(point)} comes nearest ({facts}): {line}."
        return Advice(text, None)
    of = f"of {len(known)} measured settings {_name(point)} is {praise}"
    return Advice(f"{aim} {of} ({facts}): {line}.", best)


def _cheapest(points: Sequence[Mapping[str, Any]], some: Sequence[int]) -> int | None:
    """Return the cheapest of some points.

    Where clocks cannot tell several apart, within their spreads, it is one that keeps to the
    specification where there is one: what noise favours is no advice.
    """
    if not some:
        return None

    def spread(i: int) -> float:
        # A point whose runs were disturbed is not the cheaper for that.
        return float(min(points[i]["spread"], _MOST_SPREAD * points[i]["seconds"]))

    latest = min(points[i]["seconds"] + spread(i) for i in some)
    alike = [i for i in some if points[i]["seconds"] - spread(i) <= latest]
    return min(alike, key=lambda i: (KINDS.index(points[i]["kind"]), points[i]["seconds"]))


def _name(point: Mapping[str, Any]) -> str:
    return f"{point['renderer']} {point['label']}"


def _time(seconds: float) -> str:
    return f"{seconds:.3g} s" if seconds >= 0.1 else f"{1e3 * seconds:.3g} ms"
