"""The page's plots as SVG, made here: nothing is drawn by a script, so that they print and diff.

Both have the same axis of differences, 1e-16 to 10, in every scene and every report. Lanes are told
apart by colour and by dashes, and are named at the top.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from markupsafe import Markup, escape

from crosstrace.harness.spread import EDGES, TEXTS

#: The axis of differences in decades, and that of shares of the pixels.
_LEFT, _RIGHT = -16, 1
_LEAST_SHARE = -6

_WIDTH, _HEIGHT = 560, 220
_MARGIN = {"left": 58, "right": 12, "top": 30, "bottom": 40}
_DASHES = ("", "7 3", "2 3", "9 3 2 3", "4 2", "1 2")


def curves(title: str, pairs: Sequence[tuple[str, Mapping[str, Any]]]) -> Markup:
    """Draw the share of pixels that differ by more than x, log-log, with the 99.9th percentile.

    `pairs` are names and records of pairs that were compared.
    """
    body = [*_frame(title, "share of pixels that differ by more", _shares())]
    y = _y(math.log10(1 - 0.999), _LEAST_SHARE, 0)
    right = _WIDTH - _MARGIN["right"]
    body.append(f'<path class="mark" d="M{_MARGIN["left"]} {y:.1f}H{right}"/>'
                f'<text class="soft" x="{right - 3}" y="{y - 4:.1f}" text-anchor="end">'
                "p99.9: one pixel of 1000</text>")  # fmt: skip
    for i, (name, pair) in enumerate(pairs):
        points = list(_above(pair["spread"], pair["pixels"]))
        body.append(_line(points, i, f"{name}: p99.9 {_text(pair['p999'])}"))
        if pair["p999"]:
            body.append(f'<circle class="lane{i % 6} dot" r="3.2" cx="{_x(pair["p999"]):.1f}" '
                        f'cy="{y:.1f}"><title>{escape(name)}: p99.9 = {_text(pair["p999"])}'
                        "</title></circle>")  # fmt: skip
    body += _legend([name for name, _ in pairs])
    return _svg(title, body)


def histogram(title: str, pairs: Sequence[tuple[str, Mapping[str, Any]]]) -> Markup:
    """Draw how many pixels differ by how much, six bins a decade, log-log, as steps."""
    top = max((pair["pixels"] for _, pair in pairs), default=1)
    highest = max(1, math.ceil(math.log10(max(top, 1))))
    marks = [(float(k), f"1e{k}" if k > 3 else f"{10**k}") for k in range(highest + 1)]
    body = [*_frame(title, "pixels in a bin", marks, 0, highest)]
    for i, (name, pair) in enumerate(pairs):
        body.append(_line(_steps(pair["spread"]), i, name, 0, highest))
    body += _legend([name for name, _ in pairs])
    return _svg(title, body)


def _above(spread: Mapping[str, Any], pixels: int) -> Iterator[tuple[float, float]]:
    """Yield (edge, log share of the pixels above it); below 1 pixel there is nothing to draw."""
    left = spread["beyond"] + sum(spread["counts"].values())
    for text, edge in zip(TEXTS, EDGES, strict=True):
        left -= spread["counts"].get(text, 0)
        yield edge, math.log10(left / pixels) if left else -math.inf


def _steps(spread: Mapping[str, Any]) -> list[tuple[float, float]]:
    points, before = [], EDGES[0] / 2
    for text, edge in zip(TEXTS, EDGES, strict=True):
        number = spread["counts"].get(text, 0)
        height = math.log10(number) if number else -math.inf
        points += [(before, height), (edge, height)]
        before = edge
    return points


def _line(
    points: Sequence[tuple[float, float]], i: int, name: str, low: float = _LEAST_SHARE,
    high: float = 0,
) -> str:  # fmt: skip
    """Draw a line from where there is something to where nothing is left; gaps rest on the axis."""
    some = [k for k, (_, y) in enumerate(points) if y > -math.inf]
    points = points[max(0, some[0] - 1) : some[-1] + 2] if some else []
    drawn = [f"{_x(x):.1f} {_y(max(y, low), low, high):.1f}" for x, y in points]
    dash = _DASHES[i % 6]
    return (f'<polyline class="lane{i % 6}" stroke-dasharray="{dash}" points="{",".join(drawn)}">'
            f"<title>{escape(name)}</title></polyline>")  # fmt: skip


def _frame(
    title: str, axis: str, marks: Sequence[tuple[float, str]], low: float = _LEAST_SHARE,
    high: float = 0,
) -> Iterator[str]:  # fmt: skip
    bottom, right = _HEIGHT - _MARGIN["bottom"], _WIDTH - _MARGIN["right"]
    yield f"<title>{escape(title)}</title>"
    for decade in range(_LEFT, _RIGHT + 1, 2):
        x = _x(10.0**decade)
        yield f'<path class="grid" d="M{x:.1f} {_MARGIN["top"]}V{bottom}"/>'
        label = f"1e{decade}" if decade else "1"
        yield f'<text x="{x:.1f}" y="{bottom + 14}" text-anchor="middle">{label}</text>'
    for at, label in marks:
        y = _y(at, low, high)
        yield f'<path class="grid" d="M{_MARGIN["left"]} {y:.1f}H{right}"/>'
        yield f'<text x="{_MARGIN["left"] - 5}" y="{y + 4:.1f}" text-anchor="end">{label}</text>'
    middle = (_MARGIN["left"] + right) / 2
    yield (f'<text class="soft" x="{middle:.0f}" y="{_HEIGHT - 8}" text-anchor="middle">'
           "greatest |a − b| of a pixel's channels, linear float</text>")  # fmt: skip
    half = (_MARGIN["top"] + bottom) / 2
    yield (f'<text class="soft" transform="translate(11 {half:.0f}) rotate(-90)" '
           f'text-anchor="middle">{escape(axis)}</text>')  # fmt: skip


def _shares() -> list[tuple[float, str]]:
    labels = {0: "all", -1: "10 %", -2: "1 %", -3: "0.1 %"}
    return [(float(k), labels.get(k, f"1e{k}")) for k in range(0, _LEAST_SHARE - 1, -1)]


def _legend(names: Sequence[str]) -> Iterator[str]:
    width = (_WIDTH - _MARGIN["left"] - _MARGIN["right"]) / max(1, len(names))
    for i, name in enumerate(names):
        x = _MARGIN["left"] + i * width
        short = name if len(name) <= 24 else f"{name[:23]}…"
        yield f'<path class="lane{i % 6}" stroke-dasharray="{_DASHES[i % 6]}" d="M{x:.0f} 14h26"/>'
        yield f'<text x="{x + 31:.0f}" y="18">{escape(short)}</text>'


def _svg(title: str, body: Sequence[str]) -> Markup:
    inside = "\n".join(body)
    return Markup(
        f'<svg class="plot" role="img" aria-label="{escape(title)}" '
        f'viewBox="0 0 {_WIDTH} {_HEIGHT}">\n{inside}\n</svg>'
    )


def _x(value: float) -> float:
    share = (math.log10(value) - _LEFT) / (_RIGHT - _LEFT)
    span = _WIDTH - _MARGIN["left"] - _MARGIN["right"]
    return _MARGIN["left"] + min(max(share, 0.0), 1.0) * span


def _y(value: float, low: float, high: float) -> float:
    span = _HEIGHT - _MARGIN["top"] - _MARGIN["bottom"]
    return _HEIGHT - _MARGIN["bottom"] - (value - low) / (high - low) * span


def _text(value: float | None) -> str:
    return "not finite" if value is None else f"{value:.2g}"
