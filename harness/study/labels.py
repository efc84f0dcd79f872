"""Where words go beside marks, so that none covers another: the first free place of a few."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

_HEIGHT = 12.0

#: Where a label may stand about its mark: right, left, above and below, then further away.
_OFFSETS = (
    (9, 4, 0.0), (-9, 4, 1.0), (7, -8, 0.0), (7, 15, 0.0), (-7, -8, 1.0), (-7, 15, 1.0),
    (0, -12, 0.5), (0, 20, 0.5), (12, -20, 0.0), (12, 27, 0.0), (-12, -20, 1.0), (-12, 27, 1.0),
)  # fmt: skip

#: A line is as good as points so far apart.
_LINE_STEP = 6.0

#: Half the side of a mark.
_MARK = 4.0

Box = tuple[float, float, float, float]


class Labels:
    """Labels inside a box (left, top, right, bottom), clear of marks at some places."""

    def __init__(self, bounds: Box, marks: Sequence[tuple[float, float]]) -> None:
        """Begin with the marks."""
        self._bounds = bounds
        self._taken: list[Box] = [
            (x - _MARK, y - _MARK, x + _MARK, y + _MARK) for x, y in marks
        ]  # fmt: skip

    def keep_off(self, line: Sequence[tuple[float, float]]) -> None:
        """Keep labels off a line through some places."""
        for (x, y), (to_x, to_y) in pairwise(line):
            n = max(1, round(max(abs(to_x - x), abs(to_y - y)) / _LINE_STEP))
            for i in range(n + 1):
                at_x, at_y = x + (to_x - x) * i / n, y + (to_y - y) * i / n
                self._taken.append((at_x - 1, at_y - 1, at_x + 1, at_y + 1))

    def place(self, text: str, x: float, y: float, advance: float) -> tuple[float, float] | None:
        """Return the left end of a text's baseline near a mark; None: there is no room.

        `advance` is the width of a character.
        """
        width = advance * len(text)
        for right, down, share in _OFFSETS:
            left, base = x + right - share * width, y + down
            box = (left, base - _HEIGHT + 2, left + width, base + 3)
            inside = (
                box[0] >= self._bounds[0] and box[1] >= self._bounds[1]
                and box[2] <= self._bounds[2] and box[3] <= self._bounds[3]
            )  # fmt: skip
            if inside and not any(_overlap(box, other) for other in self._taken):
                self._taken.append(box)
                return left, base
        return None


def _overlap(a: Box, b: Box) -> bool:
    return a[0] < b[2] and b[0] < a[2] and a[1] < b[3] and b[1] < a[3]
