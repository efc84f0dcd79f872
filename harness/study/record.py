"""A study's record: `study.json`, and the part `study` of a report."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from crosstrace.harness.study.advice import Advice, Wish, advise
from crosstrace.harness.study.experiment import Entry, Options

SCHEMA = "crosstrace-study/1"


def advice(done: Sequence[Entry], wish: Wish) -> list[Advice]:
    """Return the advice for each scene, in order."""
    return [advise(entry.points, wish) for entry in done]


def record(done: Sequence[Entry], options: Options, wish: Wish) -> dict[str, Any]:
    """Return the JSON-ready result; `points[]` and `advice` are the stable keys of the interface.

    With several scenes `points` has those of all, each with its `scene`, and `advice` a sentence
    for each.
    """
    said = advice(done, wish)
    several = len(done) > 1
    sentences = [
        f"{entry.source.name}: {it.sentence}" if several else it.sentence
        for entry, it in zip(done, said, strict=True)
    ]
    return {
        "schema": SCHEMA,
        "metric": options.metric,
        "clock": options.clock,
        "threads": options.threads,
        "want": wish.want if wish.budget_s is None else None,
        "budget_seconds": wish.budget_s,
        "scenes": [
            {
                "name": entry.source.name,
                "sha256": entry.scene.sha256,
                "size": list(entry.scene.shape[:2]),
                "own_size": list(entry.source.scene.shape[:2]),
                "max_depth": entry.scene.max_depth,
                "references": entry.references,
                "failures": entry.failures,
                "advised": None if it.point is None else entry.points[it.point],
            }
            for entry, it in zip(done, said, strict=True)
        ],
        "points": [point for entry in done for point in entry.points],
        "advice": " ".join(sentences),
    }
