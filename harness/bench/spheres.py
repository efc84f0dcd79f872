"""Crowds of spheres: how fast they are read, sorted and met, and how much memory they take."""

from __future__ import annotations

import time
from typing import Any

import numpy as np

from crosstrace.harness.bench import rows
from crosstrace.harness.bench.intersection import against_embree
from crosstrace.harness.bench.rays import of_picture
from crosstrace.harness.bench.runs import Runs
from crosstrace.harness.memory import PeakMemory
from crosstrace.native import _core
from crosstrace.translators.course import parse
from crosstrace.translators.native import timing

_ROWS, _COLUMNS = 1080, 1920
_MATERIAL = "0.2 0.7 0 1 0 0 1"

#: With fewer, what every process holds is more than theirs.
_MANY = 100_000


def name_of(n: int) -> str:
    """Return the name of a crowd in a table."""
    return f"{n} spheres"


def text_of(n: int) -> str:
    """Return a scene file of n spheres at random places in a cube, the same in every run.

    The spheres fill a twentieth of the cube, so that a ray passes many.
    """
    rng = np.random.default_rng(1)
    places = rng.uniform(-10, 10, (n, 3))
    radii = 6 / np.cbrt(n) * rng.uniform(0.5, 1, n)
    colors = rng.integers(30, 256, (n, 3))
    head = f"{_ROWS} {_COLUMNS}\n{1.2 / _ROWS!r} 1.5\n0 -26 3\n0 0 0\n0 0 1\n90 120 200\n0\n{n}\n"
    spheres = [
        f"{r} {g} {b} {_MATERIAL} * {x:.6f} {y:.6f} {z:.6f} {radius:.7f}"
        for (r, g, b), (x, y, z), radius in zip(
            colors.tolist(), places.tolist(), radii.tolist(), strict=True
        )
    ]
    return head + "\n".join(spheres) + "\n255 255 255\n1\n200 200 200 -30 -40 50\n"


def measure(name: str, n: int, repeat: int) -> list[dict[str, Any]]:
    """Return the rows of a crowd; to be called in a process that has done nothing else."""
    text = text_of(n).encode()
    held = []
    if n >= _MANY:
        peak = Runs([_bytes_at_most(text) / n])
        held.append(rows.own(f"{name}: memory at most, a sphere", peak, "bytes"))
    reading, sorting, tree = Runs(), Runs(), None
    scene = parse(text, name)
    for _ in range(repeat):
        began = time.process_time()
        scene = parse(text, name)
        reading.values.append(len(text) / (time.process_time() - began) / 1e6)
        tree = None
        began = time.process_time()
        tree = _core.tree(scene.native_view(), None)
        sorting.values.append(time.process_time() - began)
    return [
        rows.own(f"{name}: text read", reading, "MB/s"),
        rows.own(f"{name}: tree built", sorting, "s"),
        *held,
        *against_embree(name, scene, of_picture(scene), repeat, tree, also="single"),
    ]


def _bytes_at_most(text: bytes) -> float:
    """Return by how much memory grows from the text in it to the end of a frame of a few pixels.

    The first frame of a process: what a later one takes may have been given back before.
    """
    with PeakMemory() as before:
        pass
    with PeakMemory() as peak:
        small = parse(text).resized(54, 96)
        timing.frame(small, np.zeros(small.shape))
    return (peak.mib - before.mib) * 2**20
