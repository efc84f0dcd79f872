"""Metamorphic checks: changes of a scene that must leave a renderer's picture as it was.

`translators/metamorphic.py` has the changes. How far the two images a, b of a lane may be apart, in
a pixel and channel, with u the unit of its arithmetic, D the depth and L the lights of the changed
scene:

- **0** for native where neither numbers nor operations change but by a power of two (`rounds` is
  false). Where objects are reordered, ties that only rounding makes are left out: pixels that are
  not certified under an error of κu.
- **2u (D + 1)(2L + 8) · max(a, b)** where coordinates stay (`moves` is false): geometry is the same
  to the bit, all terms are ≥ 0, and a hit adds or scales at most 2L + 8 times.
- **the widths of the two inflated enclosures** where coordinates move. The certified kernel with
  κu encloses all that arithmetic of that error may return (truth.py), so a, b and both scenes'
  truths lie inside; what rounding the changed scene's numbers does to the view is added to κu.
  Pixels are left out only where one of the enclosures is wider than `Way.tolerance`. Types
  wider than double are held to double's bound, since the changed numbers are doubles; where these
  are exact (`axes`) the widths, which grow with u, are scaled by u / 2⁻⁵³, to first order.

Output adds half a step of quantisation for each image; POV-Ray keeps colours in float32, so its
second term has u = 2⁻²⁴. All enclosures are those of the emulation in a lane's ledger.
Some of these are in world units, so that a change is no invariance for that lane: Mitsuba's ray
offset, (1 + max|p|) 8.94e-5, depends on where a scene lies and how large it is; mitsuba-f64 has a
fixed ε; POV-Ray's tolerances are constants of a world that we scale by a power of two only up to
128. There the difference must be what the enclosures of the two scenes allow (`own_rule`).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crosstrace.harness import tasks
from crosstrace.harness.arithmetics import DOUBLE, Way, ways
from crosstrace.harness.lanes import REFERENCE, loaded
from crosstrace.translators.errors import UnsupportedSceneError
from crosstrace.translators.ledger import Emulation
from crosstrace.translators.metamorphic import RELATIONS, Relation, view_error
from crosstrace.translators.native.truth import certify
from crosstrace.translators.renderer import Rendering, RenderOptions
from crosstrace.translators.scene import Scene

Array = NDArray[np.float64]

#: What float's smallest normal number, or less, may turn into: no bound is meant to hold below.
_TINY = 2.0**-120


@dataclass(frozen=True)
class Outcome:
    """How one relation holds for one arithmetic.

    `compared` of `pixels` are compared; `max` is their greatest difference, `bound` the greatest
    that is allowed in one of them, `over` the number beyond their own bound. None: no pixel.
    """

    relation: str
    renderer: str
    precision: str
    pixels: int
    compared: int
    over: int
    max: float | None
    bound: float | None
    own_rule: bool
    note: str = ""


def check(lane: str, scene: Scene, options: RenderOptions) -> list[Outcome]:
    """Render a scene and its changes, and compare; runs in a worker process.

    `options` give threads and time limit. Raises what the lane raises.
    """
    enclose = _Encloser(options.threads)
    base = {way: _render(way, scene, options, {}) for way in ways(lane, scene)}
    meaning = _meaning(lane, scene, {})
    outcomes = []
    for relation in RELATIONS:
        changed = relation.apply(scene)
        readings = relation.readings if lane == REFERENCE else {}
        changed_meaning = _meaning(lane, changed, readings)
        for way, before in base.items():
            try:
                made = _render(way, changed, options, readings)
            except UnsupportedSceneError as error:
                pixels = scene.v_res * scene.h_res
                outcomes.append(Outcome(relation.name, lane, way.precision, pixels, 0, 0, None,
                                        None, False, str(error)))  # fmt: skip
                continue
            pair = _Pair(relation, way, meaning, changed_meaning, before, made)
            outcomes.append(_judge(pair, enclose))
    return outcomes


@dataclass(frozen=True)
class _Pair:
    """Two renderings, and what the lane takes their scenes to mean."""

    relation: Relation
    way: Way
    meaning: Emulation
    changed: Emulation
    before: Rendering
    after: Rendering

    @property
    def own_rule(self) -> bool:
        """Whether the lane has a rule in world units that makes this change no invariance."""
        relation, lane = self.relation, self.way.lane
        if lane == "mitsuba":
            return relation.moves
        if lane == "mitsuba-f64":
            return relation.factor != 1.0
        if lane != "povray":
            return False
        before, after = (float(made.settings["world_scale"]) for made in (self.before, self.after))
        return after * relation.factor != before

    @property
    def difference(self) -> Array:
        """The changed image minus the original, low parts included, (v_res, h_res, 3)."""
        apart = self.relation.undo(self.after.image) - self.before.image
        if "image_low" in self.after.layers:
            low = self.relation.undo(self.after.layers["image_low"])
            apart += low - self.before.layers["image_low"]
        return np.asarray(apart)

    @property
    def output_error(self) -> Array:
        """What quantisation and the rounding of colours may put between the images."""
        value = np.maximum(np.abs(self.relation.undo(self.after.image)), np.abs(self.before.image))
        scene = self.changed.scene
        steps = (scene.max_depth + 1) * (2 * scene.n_lights + 8)
        halves = self.before.half_step + self.after.half_step
        return np.asarray(2 * self.way.arithmetic.color_unit * steps * value + halves + _TINY)


@dataclass(frozen=True)
class _Known:
    """Inflated enclosures (v_res, h_res, 3), and which pixels have one; elsewhere it is NaN."""

    lo: Array
    hi: Array
    decidable: NDArray[np.bool_]


class _Encloser:
    """Inflated enclosures of the scenes of one check, each made once and only where it counts."""

    def __init__(self, threads: int) -> None:
        self._threads = threads
        self._made: dict[Any, _Known] = {}

    def __call__(
        self, way: Way, meaning: Emulation, among: NDArray[np.bool_], more: float = 0.0
    ) -> _Known:
        """Enclose the pixels of `among` (v_res, h_res), with `more` relative error than the lane's.

        Glass is dear to enclose in float32 where nothing comes of it.
        """
        error = way.arithmetic.kappa * max(way.arithmetic.unit, DOUBLE) + more
        scene, texts = meaning.scene, tuple(sorted(meaning.readings.items()))
        key = (scene.sha256, error, way.tolerance, texts, among.tobytes())
        if key not in self._made:
            some = certify(
                scene, meaning.readings, pixels=np.flatnonzero(among), tolerance=way.tolerance,
                kappa=error, threads=self._threads,
            )  # fmt: skip
            lo, hi = np.full((2, *scene.shape), np.nan)
            decidable = np.zeros(among.shape, np.bool_)
            lo[among], hi[among], decidable[among] = some.lo, some.hi, ~some.undecidable
            self._made[key] = _Known(lo, hi, decidable)
        return self._made[key]


def _render(
    way: Way, scene: Scene, options: RenderOptions, readings: Mapping[str, str]
) -> Rendering:
    if way.lane != REFERENCE:
        return tasks.render(way.lane, scene, options)[0]
    how = RenderOptions(options.threads, readings, way.precision, None, options.timeout_s, True)
    return tasks.render(way.lane, scene, how)[0]


def _meaning(lane: str, scene: Scene, readings: Mapping[str, str]) -> Emulation:
    return loaded(lane).ledger(scene).emulation or Emulation(scene, readings)


def _judge(pair: _Pair, enclose: _Encloser) -> Outcome:
    relation, way = pair.relation, pair.way
    apart = pair.difference
    compared = np.ones(apart.shape[:2], np.bool_)
    bound, middle = pair.output_error, np.zeros_like(apart)
    if way.lane == REFERENCE and not relation.rounds:
        bound = np.zeros_like(apart)
    elif relation.moves:
        before, after = _enclosures(pair, enclose)
        compared = after.decidable
        bound, middle = _allowed(pair, before, after)
    if relation.ties:
        compared = enclose(way, pair.meaning, compared).decidable
    distance = np.abs(apart - middle)
    inside = (distance <= bound).all(axis=-1)
    any_compared = bool(compared.any())
    return Outcome(
        relation=relation.name,
        renderer=way.lane,
        precision=way.precision,
        pixels=compared.size,
        compared=int(compared.sum()),
        over=int((compared & ~inside).sum()),
        max=float(np.abs(apart)[compared].max()) if any_compared else None,
        bound=float((bound + np.abs(middle))[compared].max()) if any_compared else None,
        own_rule=pair.own_rule,
    )


def _enclosures(pair: _Pair, enclose: _Encloser) -> tuple[_Known, _Known]:
    """Enclose both scenes; the second only where the first is decidable."""
    way, meaning = pair.way, pair.meaning
    before = enclose(way, meaning, np.ones(meaning.scene.shape[:2], np.bool_))
    if not pair.relation.exact:
        turned = view_error(meaning.scene, pair.changed.scene)
        before = enclose(way, meaning, before.decidable, turned)
    return before, enclose(way, pair.changed, before.decidable)


def _allowed(pair: _Pair, before: _Known, after: _Known) -> tuple[Array, Array]:
    """Return the bound of |difference − middle|, and that middle: 0 unless a rule is the lane's."""
    lo, hi = pair.relation.undo(after.lo), pair.relation.undo(after.hi)
    with np.errstate(invalid="ignore"):
        widths = (before.hi - before.lo) + (hi - lo)
        if pair.own_rule:
            middle = np.asarray(((lo - before.hi) + (hi - before.lo)) / 2)
            return widths / 2 + pair.output_error, middle
    unit = pair.way.arithmetic.unit
    if pair.relation.exact and unit < DOUBLE:
        widths = widths * (unit / DOUBLE)
    return np.asarray(widths + pair.output_error), np.zeros_like(widths)
