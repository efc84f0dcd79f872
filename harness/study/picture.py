"""The picture of a study: error against time, both logarithmic, as one SVG.

Shapes are renderers. Each kind of error has a Pareto front of its own: a line with its own dashes,
its colour (Okabe and Ito's, which colour-blind people tell apart) and its name at the end; the
points on it are filled and named, all others small, grey and hollow. Text and axes have the
`currentColor` of where the picture stands, which it sets itself where it stands alone.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from html import escape
from typing import Any

from crosstrace.harness.study.axes import Axis, decades
from crosstrace.harness.study.errors import METRICS
from crosstrace.harness.study.labels import Labels
from crosstrace.harness.study.points import KINDS

WIDTH, HEIGHT = 960, 640

#: Room around the plot: left, right, top, bottom.
_LEFT, _RIGHT, _TOP, _BOTTOM = 74, 24, 58, 78

#: Kind → its colour and dashes.
LINES = {
    "rounding": ("#0072b2", ""),
    "certified": ("#b07cc6", "1 4"),
    "model": ("#cc79a7", "2 3 8 3"),
    "offset": ("#e69f00", "8 3"),
    "pruning": ("#56b4e9", "12 3 2 3"),
    "depth": ("#009e73", "4 4"),
    "sampling": ("#d55e00", "10 5"),
}

#: Renderer → the path of its mark, about 0 0.
SHAPES = {
    "native": "M-5 0A5 5 0 1 0 5 0A5 5 0 1 0 -5 0Z",
    "mitsuba": "M-4.5-4.5H4.5V4.5H-4.5Z",
    "mitsuba-f64": "M0-6.5L6.5 0L0 6.5L-6.5 0Z",
    "povray": "M0-6L6 5H-6Z",
}

_STYLE = """svg{color:#1b1b1b;font:12px system-ui,sans-serif}
@media(prefers-color-scheme:dark){svg{color:#ececec}}
text{fill:currentColor}.grid{stroke:currentColor;stroke-opacity:.14}
.soft{fill:none;stroke:currentColor;stroke-opacity:.38}.title{font-size:15px;font-weight:600}
.small{font-size:11px}.front{fill:none;stroke-width:2}"""


def picture(points: Sequence[Mapping[str, Any]], metric: str, clock: str = "wall") -> str:
    """Draw records of points: one plot a scene, one below the other."""
    scenes = list(dict.fromkeys(point["scene"] for point in points))
    height = HEIGHT * max(1, len(scenes))
    body = []
    for i, name in enumerate(scenes):
        some = [point for point in points if point["scene"] == name]
        body.append(f'<g transform="translate(0 {i * HEIGHT})">')
        body += _plot(name, some, metric, clock)
        body.append("</g>")
    head = (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {height}" '
        f'width="{WIDTH}" height="{height}" role="img" aria-label="Error against time">'
    )
    return "\n".join([head, f"<style>{_STYLE}</style>", *body, "</svg>"]) + "\n"


def _plot(name: str, points: Sequence[Mapping[str, Any]], metric: str, clock: str) -> Iterator[str]:
    known = [p for p in points if p["error"][metric] is not None and p["seconds"] > 0]
    yield f'<text class="title" x="{_LEFT}" y="24">{escape(name)}: what accuracy costs</text>'
    yield from _legend({p["renderer"] for p in known})
    if not known:
        yield f'<text x="{_LEFT}" y="90">nothing was measured</text>'
        return
    across = Axis.around([p["seconds"] for p in known], _LEFT, WIDTH - _RIGHT)
    up = Axis.around([p["error"][metric] for p in known], HEIGHT - _BOTTOM, _TOP)
    yield from _grid(across, up, metric, clock)
    places = [(across(p["seconds"]), up(p["error"][metric])) for p in known]
    for point, (x, y) in zip(known, places, strict=True):
        if not point["pareto"]:
            yield _mark(point, x, y, 'class="soft"', 0.7)
    fronts = {}
    labels = Labels((_LEFT, _TOP, WIDTH - _RIGHT, HEIGHT - _BOTTOM), places)
    for kind in KINDS:
        front = [
            (point, place)
            for point, place in zip(known, places, strict=True)
            if point["kind"] == kind and point["pareto"]
        ]
        if front:
            # From the left; of two at one time the worse first, as a front falls.
            fronts[kind] = sorted(front, key=lambda it: it[1])
            labels.keep_off([place for _, place in fronts[kind]])
    for kind, front in fronts.items():
        yield from _front(kind, front, labels)


def _front(
    kind: str, front: Sequence[tuple[Mapping[str, Any], tuple[float, float]]], labels: Labels
) -> Iterator[str]:
    color, dashes = LINES[kind]
    path = " ".join(f"{x:.1f},{y:.1f}" for _, (x, y) in front)
    yield (
        f'<polyline class="front" points="{path}" stroke="{color}" '
        f'stroke-dasharray="{dashes or "none"}"/>'
    )
    for point, (x, y) in front:
        yield _mark(point, x, y, f'fill="{color}" stroke="{color}"', 1.0)
    # The last point's name first: beside it that of the front.
    for number, (point, (x, y)) in enumerate(reversed(front)):
        words = [(_short_label(point), 6.0, 'class="small"')]
        words += [(kind, 7.6, 'font-weight="700"')] if number == 0 else []
        for text, advance, look in words:
            said = labels.place(text, x, y, advance)
            if said:
                yield f'<text {look} x="{said[0]:.1f}" y="{said[1]:.1f}">{escape(text)}</text>'


def _short_label(point: Mapping[str, Any]) -> str:
    """Name a point by what tells it from its neighbours: its shape says the renderer."""
    text = str(point["label"])
    if point["kind"] in ("depth", "pruning", "offset"):
        text = text.removeprefix("f64 ")
    if text == "default":
        return str(point["renderer"])
    # Its error is 0 because it is what the others are measured with.
    return f"{text} (yardstick)" if text == "f128" and point["kind"] == "rounding" else text


def _mark(point: Mapping[str, Any], x: float, y: float, look: str, size: float) -> str:
    said = f"{point['renderer']} {point['label']} ({point['kind']}): {point['seconds']:.3g} s"
    return (
        f'<path d="{SHAPES.get(point["renderer"], SHAPES["native"])}" {look} '
        f'transform="translate({x:.1f} {y:.1f}) scale({size})"><title>{escape(said)}</title></path>'
    )


def _legend(renderers: set[str]) -> Iterator[str]:
    x = _LEFT + 4.0
    for name, shape in SHAPES.items():
        if name in renderers:
            yield f'<path d="{shape}" fill="currentColor" transform="translate({x} 42)"/>'
            yield f'<text x="{x + 11}" y="46">{name}</text>'
            x += 30 + 7.2 * len(name)
    yield f'<path d="{SHAPES["native"]}" class="soft" transform="translate({x} 42) scale(.7)"/>'
    yield f'<text x="{x + 11}" y="46">not on the front of its kind</text>'


def _grid(across: Axis, up: Axis, metric: str, clock: str) -> Iterator[str]:
    left, right, top, bottom = _LEFT, WIDTH - _RIGHT, _TOP, HEIGHT - _BOTTOM
    for exponent in decades(across):
        x = across(10.0**exponent)
        yield f'<line class="grid" x1="{x:.1f}" y1="{top}" x2="{x:.1f}" y2="{bottom}"/>'
        yield f'<text x="{x:.1f}" y="{bottom + 18}" text-anchor="middle">{_power(exponent)}</text>'
    for exponent in decades(up):
        y = up(10.0**exponent)
        yield f'<line class="grid" x1="{left}" y1="{y:.1f}" x2="{right}" y2="{y:.1f}"/>'
        yield f'<text x="{left - 8}" y="{y + 4:.1f}" text-anchor="end">{_power(exponent)}</text>'
    if up.has_zero:
        y = up(0.0)
        yield f'<line class="grid" x1="{left}" y1="{y:.1f}" x2="{right}" y2="{y:.1f}"/>'
        yield f'<text x="{left - 8}" y="{y + 4:.1f}" text-anchor="end">0</text>'
    said = "seconds an image" if clock == "wall" else "processor seconds an image"
    middle, height = (left + right) / 2, (top + bottom) / 2
    yield f'<text x="{middle}" y="{bottom + 40}" text-anchor="middle">{said}</text>'
    yield (
        f'<text transform="translate(18 {height}) rotate(-90)" text-anchor="middle">'
        f"{METRICS[metric]} on linear float</text>"
    )
    yield (
        f'<text class="small" x="{left}" y="{bottom + 62}">Kinds of error are measured against '
        "different things, and not mixed: lines join those that none of their own kind beats."
        "</text>"
    )


def _power(exponent: int) -> str:
    digits = str(exponent).translate(str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"))
    return "1" if exponent == 0 else f"10{digits}" if math.isfinite(exponent) else ""
