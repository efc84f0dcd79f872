"""Rows of a benchmark's table: ours, theirs, and by how much ours is the better.

`ratio` is larger where ours is faster, whether the numbers are times or rates. A row without a
number of theirs stands for itself. Medians of the runs; all runs are in `runs`.
"""

from __future__ import annotations

import statistics
from collections.abc import Mapping
from typing import Any

from crosstrace.harness.bench.runs import Runs


def rate(scene: str, one: Runs, n_rays: int) -> dict[str, Any]:
    """Rays of every kind a second of one thread's processor time, with all of their shading."""
    runs = [n_rays / seconds / 1e6 for seconds in one.values]
    return _row(f"{scene}: all rays, 1 thread", runs, [], "Mrays/s", one, n_rays=n_rays)


def own(name: str, ours: Runs, unit: str) -> dict[str, Any]:
    """What nothing else is held against."""
    return _row(name, ours.values, [], unit, ours)


def failed(name: str, error: Exception) -> dict[str, Any]:
    """What has no numbers, and why."""
    runs = Runs()
    runs.fail("failed", str(error))
    return _row(name, [], [], "", runs)


def against(name: str, ours: Runs, theirs: Runs) -> dict[str, Any]:
    """Seconds of ours against others, or of two of our own ways."""
    return _row(name, ours.values, theirs.values, "s", ours, theirs)


def threads(scene: str, one: Runs, two: Runs) -> dict[str, Any]:
    """Frames on two threads (ours) against one: 2 is the best that can be."""
    return against(f"{scene}: 2 threads for 1", two, one)


def frame(scene: str, lane: str, ours: Runs, theirs: Runs) -> dict[str, Any]:
    """Frames on all cores, in the same image size, of warm renderers."""
    return against(f"{scene}: frame, {lane}", ours, theirs)


def embree(
    scene: str,
    kind: str,
    ours: Runs,
    theirs: Mapping[tuple[str, str], Runs],
    agreement: Mapping[str, float],
    absent: str,
) -> dict[str, Any]:
    """Nearest hits alone, one thread, both streaming from memory: Embree's fastest mode."""
    modes = {f"{version} {mode}": runs.values for (version, mode), runs in theirs.items()}
    title = f"{scene}: {kind} rays, Embree"
    if not modes:
        row = _row(title, ours.values, [], "Mrays/s", ours)
        return row | {"status": "missing", "message": absent}
    best = max(modes, key=lambda name: statistics.median(modes[name]))
    row = _row(f"{title} {best}", ours.values, modes[best], "Mrays/s", ours)
    medians = {name: statistics.median(values) for name, values in modes.items()}
    return row | {"modes": medians, "same_hits": dict(agreement)}


def peak(scene: str, instructions: str, ours: Runs, most: Runs) -> dict[str, Any]:
    """What the nearest hits of rays in cache need, against what the processor can do unfused."""
    title = f"{scene}: nearest hit, peak {instructions}"
    return _row(title, ours.values, most.values, "Gflop/s", ours)


def _row(
    name: str, ours: list[float], theirs: list[float], unit: str, *runs: Runs, **more: Any
) -> dict[str, Any]:
    a, b = (statistics.median(values) if values else None for values in (ours, theirs))
    ratio = None
    if a and b:
        ratio = b / a if unit == "s" else a / b
    bad = next((it for it in runs if it.status != "ok"), None)
    return {
        "name": name,
        "ours": a,
        "theirs": b,
        "ratio": ratio,
        "unit": unit,
        "status": bad.status if bad else "ok",
        "message": bad.message if bad else "",
        "runs": {"ours": ours, "theirs": theirs},
        **more,
    }
