"""What the reference tracer makes of a scene, in few bytes, and whether it is still the same.

A fingerprint is the float64 image and the ray tree of every pixel at a reduced size, and a digest
of the ray trees of every row and every column at full size, so that a changed pixel is named there
too. Two fingerprints are compared by what real arithmetic allows, not by bits:

- a value that moved by more than the tolerance of its class `equal` has changed, unless the old
  value and the new one are both `equal`, `rounding` or `undecidable` against today's truth;
- a ray tree that is another one has changed, unless real arithmetic leaves the pixel open or the
  rounding of double makes more than one tree there (`conditioning.envelope`): on a horizon there
  are hundreds, and none is the right one;
- a row or column whose digest is another one has changed, unless it holds such a pixel.

What is so excused is noted: another compiler or processor may do it.
"""

from __future__ import annotations

import hashlib
import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from crosstrace.harness.classes import NAMES, Class, classify, tolerance
from crosstrace.harness.lanes import REFERENCE, loaded
from crosstrace.translators.native.adapter import ARITHMETIC
from crosstrace.translators.native.envelope import envelope
from crosstrace.translators.native.truth import certify
from crosstrace.translators.renderer import RenderOptions
from crosstrace.translators.scene import Scene

#: The reduced image has at most so many rows and columns: a hard scene is kept whole.
MOST_ROWS, MOST_COLUMNS = 61, 81

#: Rounding is asked about at most so many pixels, a whole reduced image among them; a change of
#: more is no matter of rounding.
_MOST_ASKED, _SAMPLES = 8192, 64

#: Pixels that are named.
NAMED = 5


@dataclass(frozen=True)
class Fingerprint:
    """`image` (r, c, 3) and `trees` (r, c) at the reduced size; digests of 8 bytes at full size.

    `row_digests` (v_res,), `column_digests` (h_res,) and `sha256` are of the full size's trees.
    """

    image: NDArray[np.float64]
    trees: NDArray[np.uint64]
    row_digests: NDArray[np.uint64]
    column_digests: NDArray[np.uint64]
    sha256: str


@dataclass(frozen=True)
class Difference:
    """One thing that is not as it was: in words, and whether it is more than rounding may do.

    `pixels` are (row, column) of the first few, at the size that the words name.
    """

    text: str
    fails: bool
    pixels: tuple[tuple[int, int], ...] = ()


def reduced(scene: Scene) -> Scene:
    """Return the scene at the size of its golden: a whole fraction, rounded up."""
    step = max(1, math.ceil(scene.v_res / MOST_ROWS), math.ceil(scene.h_res / MOST_COLUMNS))
    if step == 1:
        return scene
    return scene.resized(math.ceil(scene.v_res / step), math.ceil(scene.h_res / step))


def take(scene: Scene, threads: int = 0) -> Fingerprint:
    """Render natively at both sizes."""
    image, trees = _traced(reduced(scene), threads)
    full = trees if reduced(scene) is scene else _traced(scene, threads)[1]
    data = np.ascontiguousarray(full, "<u8")
    return Fingerprint(
        image, trees, _digests(data), _digests(data.T), hashlib.sha256(data.tobytes()).hexdigest()
    )


def take_and_compare(
    scene: Scene, golden: Fingerprint | None, threads: int = 0
) -> tuple[Fingerprint, list[Difference]]:
    """Take today's fingerprint and say what differs from an earlier one of the same scene."""
    now = take(scene, threads)
    if golden is None:
        return now, []
    small = reduced(scene)
    if golden.image.shape != now.image.shape:
        was, is_ = (f"{s[0]}x{s[1]}" for s in (golden.image.shape, now.image.shape))
        return now, [Difference(f"the reduced image is {is_} instead of {was}", True)]
    found = _values(small, golden, now, threads) + _trees(small, golden, now, threads)
    return now, found + _digested(scene, golden, now, threads)


def _traced(scene: Scene, threads: int) -> tuple[NDArray[np.float64], NDArray[np.uint64]]:
    made = loaded(REFERENCE).render(scene, RenderOptions(threads=threads, layers=True))
    return made.image, made.layers["tree"]


def _digests(lines: NDArray[np.uint64]) -> NDArray[np.uint64]:
    made = b"".join(hashlib.blake2b(line.tobytes(), digest_size=8).digest() for line in lines)
    return np.frombuffer(made, "<u8").astype(np.uint64)


def _values(small: Scene, golden: Fingerprint, now: Fingerprint, threads: int) -> list[Difference]:
    slack = tolerance(now.image, ARITHMETIC, 0.0)
    moved = ~(np.abs(now.image - golden.image) <= slack[..., None]).all(axis=-1)
    if not moved.any():
        return []
    known, ledger = certify(small, threads=threads), loaded(REFERENCE).ledger(small)
    then, after = (
        classify(small, known, image, ledger, threads=threads).classes
        for image in (golden.image, now.image)
    )
    good = (Class.EQUAL, Class.ROUNDING, Class.UNDECIDABLE)
    excused = np.isin(then, good) & np.isin(after, good)

    def told(row: int, column: int) -> str:
        a, b = then[row, column], after[row, column]
        return (
            f"{_color(golden.image[row, column])} -> {_color(now.image[row, column])}, "
            f"the golden value {NAMES[a]} and this one {NAMES[b]}"
        )

    size = f"the native image at {small.v_res}x{small.h_res}"
    return [
        _told(size, which, told, fails)
        for which, fails in ((moved & ~excused, True), (moved & excused, False))
        if which.any()
    ]


def _trees(small: Scene, golden: Fingerprint, now: Fingerprint, threads: int) -> list[Difference]:
    other = golden.trees != now.trees
    if not other.any():
        return []
    excused = np.zeros(other.shape, bool)
    pixels = np.flatnonzero(other)
    if len(pixels) <= _MOST_ASKED:
        excused.ravel()[pixels] = _floating(small, pixels, threads)

    def told(row: int, column: int) -> str:
        return f"{golden.trees[row, column]:016x} -> {now.trees[row, column]:016x}"

    size = f"the ray trees at {small.v_res}x{small.h_res}"
    return [
        _told(size, which, told, fails)
        for which, fails in ((other & ~excused, True), (other & excused, False))
        if which.any()
    ]


def _digested(
    scene: Scene, golden: Fingerprint, now: Fingerprint, threads: int
) -> list[Difference]:
    """Compare rows and columns at full size: a changed pixel lies where both changed."""
    if golden.sha256 == now.sha256 or reduced(scene) is scene:
        return []
    rows = np.flatnonzero(golden.row_digests != now.row_digests)
    columns = np.flatnonzero(golden.column_digests != now.column_digests)
    fails = True
    if 0 < len(rows) * len(columns) <= _MOST_ASKED:
        crossings = (rows[:, None] * scene.h_res + columns).ravel()
        may = _floating(scene, crossings, threads).reshape(len(rows), len(columns))
        fails = not (may.any(axis=1).all() and may.any(axis=0).all())
    text = (
        f"the ray trees at {scene.v_res}x{scene.h_res} changed in rows {_listed(rows)}, "
        f"columns {_listed(columns)}"
    )
    # With one row or one column every crossing is a changed pixel, otherwise only some are.
    named = [(int(r), int(c)) for r in rows for c in columns] if 1 in (
        len(rows), len(columns)
    ) else []  # fmt: skip
    return [Difference(_excused(text, fails), fails, tuple(named[:NAMED]))]


def _floating(scene: Scene, pixels: NDArray[np.intp], threads: int) -> NDArray[np.bool_]:
    """Say of which pixels no ray tree is the right one: open ones, and where rounding decides."""
    error, count = ARITHMETIC.error, _SAMPLES
    trees = envelope(scene, pixels=pixels, error=error, samples=count, threads=threads).trees
    several = (trees != trees[:, :1]).any(axis=1)
    undecidable = certify(scene, pixels=pixels, threads=threads).undecidable
    return np.asarray(several | undecidable)


def _told(
    where: str, which: NDArray[np.bool_], told: Callable[[int, int], str], fails: bool
) -> Difference:
    pixels = [(int(row), int(column)) for row, column in np.argwhere(which)[:NAMED]]
    count = int(np.count_nonzero(which))
    row, column = pixels[0]
    first = f"({row}, {column}): {told(row, column)}"
    text = f"{where}: pixel {first}" if count == 1 else f"{where}: {count:,} pixels, first {first}"
    return Difference(_excused(text, fails), fails, tuple(pixels))


def _excused(text: str, fails: bool) -> str:
    return text if fails else f"{text}; rounding may do so"


def _color(color: NDArray[np.float64]) -> str:
    return "(" + ", ".join(f"{value:.17g}" for value in color) + ")"


def _listed(lines: NDArray[np.intp]) -> str:
    named = ", ".join(str(line) for line in lines[:NAMED])
    return named + (f" and {len(lines) - NAMED:,} more" if len(lines) > NAMED else "")
