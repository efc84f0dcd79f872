"""One pixel explained: its ray tree, what is known of its true value, and every lane's value.

`Explanation.record` documents the keys of `crosstrace explain --json`.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import asdict, dataclass, field, replace
from typing import TYPE_CHECKING, Any

from crosstrace.harness import alone, record
from crosstrace.harness.lanes import LANES, REFERENCE, chosen
from crosstrace.translators import readings as readings_of_the_specification
from crosstrace.translators.native.explain import PixelTree, Ray, Vector, check_pixel
from crosstrace.translators.native.truth import Decision, PixelClass
from crosstrace.translators.renderer import RenderOptions
from crosstrace.translators.scene import Scene

if TYPE_CHECKING:
    from crosstrace.translators.native.truth import Enclosures

SCHEMA = "crosstrace-explain/1"

#: By the level of an enclosure.
ARITHMETIC = ("double", "double-double", "float128")

#: Called with how many steps are done, of how many, and what was last done.
Step = Callable[[int, int, str], None]


@dataclass(frozen=True)
class Enclosure:
    """What is known of the pixel's true value; see `crosstrace.translators.native.truth`.

    `lo` and `hi` are infinite where nothing is. `decision`, `depth` and `object` name the first
    open decision. `alternatives` are the [lo, hi] of the possible values of an undecidable pixel.
    """

    lo: Vector
    hi: Vector
    pixel_class: PixelClass
    decision: Decision
    depth: int
    object: int
    arithmetic: str
    alternatives: tuple[tuple[Vector, Vector], ...]

    @property
    def width(self) -> float:
        """The greatest width of a channel."""
        return max(hi - lo for lo, hi in zip(self.lo, self.hi, strict=True))

    def difference(self, value: Vector) -> tuple[Vector, int | None] | None:
        """Return how far a value lies outside (signed by channel, 0 inside), and of which
        alternative, the nearest; None where there is no enclosure or no number.
        """
        known = self.alternatives or ((self.lo, self.hi),)
        if not math.isfinite(self.width) or not all(map(math.isfinite, value)):
            return None
        off = [_outside(value, lo, hi) for lo, hi in known]
        nearest = min(range(len(off)), key=lambda i: max(map(abs, off[i])))
        return off[nearest], nearest if self.alternatives else None


@dataclass(frozen=True)
class LaneValue:
    """A lane's value at the pixel; `status` and `message` as in a report, None: no image.

    `difference` and `alternative` are those of `Enclosure.difference`. `verdict` is the class of
    the value (`classes.py`), None where there is no truth to class it by.
    """

    name: str
    status: str
    message: str = ""
    value: Vector | None = None
    half_step: float | None = None
    difference: Vector | None = None
    alternative: int | None = None
    verdict: str | None = None


@dataclass(frozen=True)
class Explanation:
    """What `explain` found; `enclosure` is None where truth has no meaning (`offset=bound`)."""

    scene: Scene
    tree: PixelTree
    enclosure: Enclosure | None
    lanes: tuple[LaneValue, ...]
    readings: Mapping[str, str] = field(default_factory=dict)

    @property
    def complete(self) -> bool:
        """Whether every lane gave an image."""
        return all(lane.status == "ok" for lane in self.lanes)

    def record(self) -> dict[str, Any]:
        """Return it JSON-ready; what is not there is null, colours are linear [r, g, b].

        `schema`, `scene` {`name`, `sha256`}, `row`, `col`, `readings`, `color`, `tree` (the hash,
        hexadecimal), `n_rays`; `rays[]`: the fields of `crosstrace.translators.native.explain.Ray`,
        kinds and decisions by name; `enclosure` {`lo`, `hi`, `class`, `decision`, `depth`,
        `object`, `arithmetic`, `alternatives[]` {`lo`, `hi`}}; `lanes[]` {`name`, `status`,
        `message`, `value`, `half_step`, `difference`, `alternative`, `class`}.
        """
        tree = self.tree
        text = record.dumps(
            {
                "schema": SCHEMA,
                "scene": {"name": self.scene.name, "sha256": self.scene.sha256},
                "row": tree.row,
                "col": tree.column,
                "readings": dict(self.readings),
                "color": tree.color,
                "tree": f"{tree.tree:016x}",
                "n_rays": tree.n_rays,
                "rays": [_ray(ray) for ray in tree.rays],
                "enclosure": None if self.enclosure is None else enclosure_record(self.enclosure),
                "lanes": [_lane(lane) for lane in self.lanes],
            }
        )
        plain: dict[str, Any] = json.loads(text)
        return plain


def explain(
    scene: Scene,
    row: int,
    col: int,
    lanes: Iterable[str] | None = None,
    readings: Mapping[str, str] | None = None,
    *,
    timeout_s: float | None = alone.TIMEOUT_S,
    step: Step | None = None,
) -> Explanation:
    """Explain the pixel in `row` and `col`, both from 0, row 0 at the top.

    `lanes` None: all. Every lane but native renders the whole scene; native's value is the tree's,
    bit for bit that of its image. `readings` are those of tree, truth and native; the other lanes
    render the default. Each worker call is given up after `timeout_s`. Raises UsageError for a
    pixel outside the image or a name that does not exist; a lane without an image is told in
    `lanes`.
    """
    names = _checked(lanes)
    readings = dict(readings or {})
    check_pixel(scene, row, col)
    readings_of_the_specification.check(readings)
    others = [name for name in names if name != REFERENCE]
    total = 1 + len(others)
    tree, known = alone.explain(scene, row, col, readings, timeout_s)
    enclosure = None if known is None else enclosure_at(known, 0)
    if step is not None:
        step(1, total, "ray tree and enclosure")

    values = {REFERENCE: _value(enclosure, REFERENCE, tree.color, 0.0)}
    options = RenderOptions(timeout_s=timeout_s)
    for done, (name, outcome) in enumerate(alone.pixels(others, scene, options, row, col), 2):
        if isinstance(outcome, BaseException):
            failed = record.failed(outcome)
            values[name] = LaneValue(name, failed["status"], failed["message"])
        else:
            values[name] = _value(enclosure, name, *outcome)
        if step is not None:
            step(done, total, f"{name} {values[name].status}")
    found = tuple(values[name] for name in names)
    if known is not None:
        rendered = {
            lane.name: (lane.value, lane.half_step or 0.0)
            for lane in found
            if lane.value is not None
        }
        classes = alone.classes_at(scene, row, col, known, rendered, readings, timeout_s)
        found = tuple(replace(lane, verdict=classes.get(lane.name)) for lane in found)
    return Explanation(scene, tree, enclosure, found, readings)


def _checked(lanes: Iterable[str] | None) -> tuple[str, ...]:
    if lanes is None:
        return LANES
    names = tuple(dict.fromkeys(lanes))
    # A renderer from outside this package goes by `module:factory`.
    foreign = tuple(name for name in names if ":" in name)
    ours = [name for name in names if name not in foreign]
    return (*(chosen(ours) if ours or not foreign else ()), *foreign)


def _value(enclosure: Enclosure | None, name: str, value: Vector, half_step: float) -> LaneValue:
    found = None if enclosure is None else enclosure.difference(value)
    difference, alternative = found if found is not None else (None, None)
    return LaneValue(name, "ok", "", value, half_step, difference, alternative)


def _outside(value: Vector, lo: Vector, hi: Vector) -> Vector:
    return _vector(
        v - h if v > h else v - low if v < low else 0.0
        for v, low, h in zip(value, lo, hi, strict=True)
    )


def enclosure_at(known: Enclosures, i: int) -> Enclosure:
    """Return pixel `i` of the enclosures of a list of pixels."""
    alternatives = known.alternatives[:0, 0]
    if known.undecidable[i]:
        at = int(known.undecidable[:i].sum())
        alternatives = known.alternatives[at, : int(known.n_alternatives[at])]
    return Enclosure(
        _vector(known.lo[i]),
        _vector(known.hi[i]),
        PixelClass(int(known.pixel_class[i])),
        Decision(int(known.decision[i])),
        int(known.depth[i]),
        int(known.object[i]),
        ARITHMETIC[int(known.level[i])],
        tuple((_vector(lo), _vector(hi)) for lo, hi in alternatives),
    )


def _vector(channels: Iterable[float]) -> Vector:
    red, green, blue = map(float, channels)
    return red, green, blue


def _ray(ray: Ray) -> dict[str, Any]:
    names = {"kind": ray.kind.name.lower(), "margin_decision": ray.margin_decision.name.lower()}
    return asdict(ray) | names


def enclosure_record(known: Enclosure) -> dict[str, Any]:
    """Return what is known of a pixel, as `Explanation.record` documents it."""
    return {
        "lo": known.lo,
        "hi": known.hi,
        "class": known.pixel_class.name.lower(),
        "decision": known.decision.name.lower(),
        "depth": known.depth,
        "object": known.object,
        "arithmetic": known.arithmetic,
        "alternatives": [{"lo": lo, "hi": hi} for lo, hi in known.alternatives],
    }


def _lane(lane: LaneValue) -> dict[str, Any]:
    named = asdict(lane)
    named["class"] = named.pop("verdict")
    return named
