"""An explained pixel in words: one line a ray, at most 100 columns, readable without colour."""

from __future__ import annotations

import math
from collections.abc import Iterator

from crosstrace.harness.explain import Enclosure, Explanation, LaneValue
from crosstrace.translators.native.explain import PixelTree, Ray, RayKind, Vector
from crosstrace.translators.native.truth import Decision, PixelClass

#: A tree of more rays than this is cut; JSON has them all.
MOST_RAYS = 200

#: Deeper rays are not indented further; their depth stands beside them.
_DEEPEST = 5

_KINDS = {
    RayKind.PRIMARY: "primary",
    RayKind.SHADOW: "light",
    RayKind.REFLECTED: "reflected",
    RayKind.REFRACTED: "refracted",
    RayKind.TOTALLY_REFLECTED: "total",
}

_DECISIONS = {
    Decision.NEAREST: "hit",
    Decision.SHADOW: "shadow",
    Decision.SIDE: "side",
    Decision.TOTAL_REFLECTION: "total",
    Decision.GATE: "n.l",
    Decision.PRECISION: "precision",
}

_UNDECIDABLE = {
    PixelClass.EDGE: "a decision is open",
    PixelClass.PRECISION: "a quantity is too wide",
    PixelClass.BUDGET: "too many outcomes",
}


def lines(found: Explanation) -> Iterator[str]:
    """Yield the lines: the pixel, what is known of it, what each lane made of it, its rays."""
    tree, scene = found.tree, found.scene
    yield (
        f"{scene.name}: row {tree.row}, column {tree.column} of {scene.v_res}x{scene.h_res}, "
        f"rays: {tree.n_rays:,}, tree {tree.tree:016x}"
    )
    yield from _truth(found.enclosure)
    yield ""
    yield from _values(found)
    yield ""
    yield from _rays(tree)


def _truth(known: Enclosure | None) -> Iterator[str]:
    if known is None:
        yield "truth: offset=bound has no meaning in real arithmetic"
        return
    if known.pixel_class == PixelClass.CERTIFIED:
        yield f"certified to a width of {known.width:.1e} in {known.arithmetic}"
        return
    yield (
        f"undecidable in {known.arithmetic}: {_UNDECIDABLE[known.pixel_class]}; "
        f"first {_decision(known.decision, known.object)} at depth {known.depth}"
    )


def _values(found: Explanation) -> Iterator[str]:
    yield f"{'':14}{'red':>18}{'green':>18}{'blue':>18}  {'off by':<10}"
    known = found.enclosure
    if known is not None and math.isfinite(known.width):
        yield from _bounds("", known.lo, known.hi)
        for i, (lo, hi) in enumerate(known.alternatives):
            yield from _bounds(f"{i}: ", lo, hi)
    for lane in found.lanes:
        yield _lane(lane)


def _bounds(prefix: str, lo: Vector, hi: Vector) -> Iterator[str]:
    yield f"{prefix + 'least':<14}{_channels(lo)}"
    yield f"{prefix + 'greatest':<14}{_channels(hi)}"


def _channels(value: Vector) -> str:
    return "".join(f" {channel:17.15f}" for channel in value)


def _lane(lane: LaneValue) -> str:
    if lane.value is None:
        return f"{lane.name:<14}{lane.status}: {lane.message}"
    off = "-"
    if lane.difference is not None:
        off = f"{max(map(abs, lane.difference)):.1e}" if any(lane.difference) else "0"
    of = "" if lane.alternative is None else f" from alternative {lane.alternative}"
    step = f" (half step {lane.half_step:.1e})" if lane.half_step else ""
    verdict = f" {lane.verdict}" if lane.verdict else ""
    return f"{lane.name:<14}{_channels(lane.value)}  {off}{of}{step}{verdict}"


def _rays(tree: PixelTree) -> Iterator[str]:
    yield _columns("ray", "weight", "hit", "at", " adds", "start", "margin")
    for ray in tree.rays[:MOST_RAYS]:
        yield _line(ray).rstrip()
    rest = tree.n_rays - min(len(tree.rays), MOST_RAYS)
    if rest:
        yield f"... {rest:,} more rays: --json lists the first {len(tree.rays):,}"
    yield "adds: to the pixel; in brackets what a light adds, already in the line of its hit"
    yield "start: relative distance from the surface that it leaves, which rounding may hit again"
    yield "margin: the relative change that would turn the decision beside it, about that object"


def _line(ray: Ray) -> str:
    is_shadow = ray.kind == RayKind.SHADOW
    depth = ray.depth + is_shadow
    deep = f" ({ray.depth})" if depth > _DEEPEST else ""
    name = f"{_KINDS[ray.kind]} {ray.light}" if is_shadow else _KINDS[ray.kind]
    label = "  " * min(depth, _DEEPEST) + name + deep
    margin = "" if math.isinf(ray.margin) else f"{ray.margin:.1e} "
    return _columns(
        label,
        _short(ray.weight),
        _hit(ray, is_shadow),
        "" if math.isinf(ray.t_world) else _short(ray.t_world),
        _adds(ray, is_shadow),
        "" if math.isinf(ray.clearance) else f"{ray.clearance:.0e}",
        margin + _decision(ray.margin_decision, ray.margin_object),
    )


def _columns(ray: str, weight: str, hit: str, at: str, adds: str, start: str, margin: str) -> str:
    return f"{ray:<24}{weight:>7} {hit:<10}{at:>7} {adds:<23}{start:>6}  {margin}"


def _hit(ray: Ray, is_shadow: bool) -> str:
    if is_shadow:
        return "clear" if ray.object < 0 else f"behind {ray.object}"
    return (
        "nothing" if ray.object < 0 else f"{ray.object} inside" if ray.inside else f"{ray.object}"
    )


def _adds(ray: Ray, is_shadow: bool) -> str:
    if is_shadow and ray.object >= 0:
        return ""
    numbers = " ".join(f"{_short(channel):>6}" for channel in ray.contribution)
    return f"({numbers})" if is_shadow else f" {numbers}"


def _decision(decision: Decision, index: int) -> str:
    name = _DECISIONS.get(decision, "")
    return f"{name} {index}" if index >= 0 else name


def _short(value: float) -> str:
    """Write a number in at most seven characters: 0.1234, 12.346, 1e-05."""
    size = abs(value)
    if value == 0 or 1e-3 <= size < 1e5:
        return f"{value:.{4 - (size >= 10) - (size >= 100) - (size >= 1e3) - (size >= 1e4)}f}"
    return f"{value:.0e}"
