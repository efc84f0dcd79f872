"""Nearest hits alone: ours in float64, Embree's in float32, and ours against the machine's peak.

Everything is of one thread. Both sides read their rays from memory, and from the same ones in the
same order; the peak is of products and sums of rays that stay in the processor's cache.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from crosstrace.harness.bench import embree, rows
from crosstrace.harness.bench.rays import Rays, of_picture
from crosstrace.harness.bench.runs import Runs
from crosstrace.translators.native.intersect import (
    instruction_sets,
    nearest,
    operations,
    peak_flops,
)
from crosstrace.translators.scene import Scene

#: How often each block of rays is traced where memory is not to count.
PASSES = 16


def measure(name: str, scene: Scene, repeat: int) -> list[dict[str, Any]]:
    """Return the rows of a scene; to be called in a process that does nothing else."""
    picture = of_picture(scene)
    return [*against_embree(name, scene, picture, repeat), *_peaks(name, scene, picture[0], repeat)]


def against_embree(
    name: str,
    scene: Scene,
    picture: Iterable[Rays],
    repeat: int,
    tree: Any = None,
    also: str = "",
) -> list[dict[str, Any]]:
    """Return a row for each kind of rays, ours against the fastest of Embree's modes.

    `tree` is what `_core.tree` made of the scene. One more row for each kind is against the mode
    `also` of any version, unless that is the fastest.
    """
    others, absent = [], "the package embreex (extra `bench`) or libembree3-3 is not installed"
    for library in embree.libraries():
        try:
            others.append(embree.Embree(library, scene))
        except (OSError, AttributeError) as error:
            absent = str(error)
    asked = [(e, mode) for e in others for mode in e.modes]
    made = []
    for rays in picture:
        ours, theirs = Runs(), {(e.version, mode): Runs() for e, mode in asked}
        agreement: dict[str, float] = {}
        for turn in range(repeat + 1):
            _, hit, seconds = nearest(scene, rays.origins, rays.directions, tree=tree)
            rates = [(ours, _millions(len(rays), seconds))]
            for e, mode in asked:
                found, seconds = e.nearest(mode, rays)
                rates.append((theirs[e.version, mode], _millions(len(rays), seconds)))
                same = float((found == hit).mean())
                agreement[e.version] = min(same, agreement.get(e.version, 1.0))
            if turn > 0:
                for into, value in rates:
                    into.values.append(value)
        made.append(rows.embree(name, rays.kind, ours, theirs, agreement, absent))
        some = {key: runs for key, runs in theirs.items() if key[1] == also}
        if some:
            more = rows.embree(name, rays.kind, ours, some, agreement, absent)
            if more["name"] != made[-1]["name"]:
                made.append(more)
    for e in others:
        e.close()
    return made


def _millions(n: int, seconds: float) -> float:
    """Return millions a second; a clock that has not moved has moved by a nanosecond."""
    return n / max(seconds, 1e-9) / 1e6


def _peaks(name: str, scene: Scene, rays: Rays, repeat: int) -> list[dict[str, Any]]:
    sets = instruction_sets()
    resident, peaks = {it: Runs() for it in sets}, {it: Runs() for it in sets}
    n = operations(scene, rays.origins, rays.directions)
    for turn in range(repeat + 1):
        for it in sets:
            _, _, seconds = nearest(scene, rays.origins, rays.directions, PASSES, it, "scan")
            peak = peak_flops(it) / 1e9
            if turn > 0:
                resident[it].values.append(_millions(PASSES * n, seconds) / 1e3)
                peaks[it].values.append(peak)
    return [rows.peak(name, it, resident[it], peaks[it]) for it in sets]
