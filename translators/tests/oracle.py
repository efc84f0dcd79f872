"""An independent slow tracer in plain numpy: the oracle that the native tracer is tested against.

It was written from the specification and the table of semantics alone and shares no code with the
project. Batches of rays are arrays, recursion is a plain recursive call. Every reading is there
under its name (`oracle_readings.py` says what each is taken to mean).

    result = oracle.render(oracle.read(text), plane_normal="raw")
    result.image    (v_res, h_res, 3) float64, linear, unclamped, row 0 at the top
    result.margin   (v_res, h_res) smallest margin of any decision in the pixel's ray tree
    result.object, result.t   what the primary ray meets (−1 and ∞: nothing) and where
    oracle.to_bytes(result.image)   the 8-bit image
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from oracle_lighting import local
from oracle_readings import Readings
from oracle_scene import Numbers, plain, read
from oracle_surfaces import NEAR_CLIP, dot, nearest, unit
from oracle_world import Hits, World

__all__ = ["Readings", "Result", "plain", "read", "render", "to_bytes"]

Floats = Any
CHUNK = 1 << 15


@dataclass(frozen=True)
class Result:
    """An image and its side outputs, each of (v_res, h_res, …); `rays` counts no shadow rays."""

    image: Floats
    object: Floats
    t: Floats
    margin: Floats
    rays: int


def render(numbers: Numbers, arithmetic: str = "double", **readings: Any) -> Result:
    """Trace every pixel; `arithmetic` is "double" or "extended" (80 bits), returned as float64."""
    kind = {"double": np.float64, "extended": np.longdouble}[arithmetic]
    tracer = _Tracer(World(numbers, kind, Readings(**readings)))
    d = tracer.world.directions().reshape(-1, 3)
    parts = [tracer.primary(d[k : k + CHUNK]) for k in range(0, len(d), CHUNK)]
    image, index, t, margin = (
        np.concatenate([part[k] for part in parts]).reshape(numbers.v_res, numbers.h_res, -1)
        for k in range(4)
    )
    return Result(
        image.astype(np.float64), index[..., 0], t[..., 0].astype(np.float64),
        margin[..., 0].astype(np.float64), tracer.rays,
    )  # fmt: skip


def to_bytes(image: Floats, overflow: str = "scale", quantise: str = "truncate") -> Floats:
    """Apply the 8-bit rule: an overflowing colour is divided by its largest component."""
    top = image.max(axis=-1, keepdims=True)
    shown = np.minimum(image, 1) if overflow == "clamp" else image / np.where(top > 1, top, 1)
    guard = 0.5 if quantise == "round" else 1e-9
    return np.floor(255 * shown + guard).astype(np.uint8)


@dataclass
class _Tracer:
    world: World
    rays: int = 0

    def primary(self, d: Floats) -> tuple[Floats, ...]:
        world = self.world
        if world.readings.offset == "mitsuba":
            skipped = NEAR_CLIP / -dot(d, world.w)
            start = world.eye + skipped[:, None] * d
            color, index, t, margin = self.trace(start, d, 0, world.around_eye())
            return color, index, t + skipped, margin
        start = np.broadcast_to(world.eye, d.shape)
        return self.trace(start, d, 0, world.around_eye(), skip=world.on_surface)

    def trace(
        self, o: Floats, d: Floats, depth: int = 0, inside_of: tuple[int, ...] = (), *,
        skip: list[bool] | None = None,
    ) -> tuple[Floats, ...]:  # fmt: skip
        """Return (colour, index, t, margin) of the rays o + t·d at this depth."""
        world = self.world
        self.rays += len(d)
        index, t, margin = nearest(world.things, o, d, world.far, skip)
        missed = np.zeros(3) if depth and world.readings.miss == "black" else world.background
        color = np.broadcast_to(missed, d.shape).astype(world.kind)
        hit = index >= 0
        if hit.any() and world.numbers.delivery == 1:
            color[hit] = world.color[index[hit]]
        elif hit.any():
            hits = self.hits(o[hit], d[hit], index[hit], t[hit], inside_of, depth=depth)
            color[hit], surely = self.shade(hits)
            margin[hit] = np.minimum(margin[hit], surely)
        if world.readings.recursion == "clamp":
            color = np.minimum(color, 1)
        elif world.readings.recursion == "scale":
            color = color / np.maximum(color.max(axis=-1, keepdims=True), 1)
        return color, index, t, margin

    def hits(
        self, o: Floats, d: Floats, i: Floats, t: Floats, inside_of: tuple[int, ...], *, depth: int
    ) -> Hits:
        """Find the points o + t·d and the normals of things i there."""
        world = self.world
        p = o + t[:, None] * d
        n, literal = np.empty_like(p), np.empty_like(p)
        for k in np.unique(i):
            thing, at = world.things[k], i == k
            where = np.array(thing.where, world.kind)
            if thing.sphere:
                n[at] = literal[at] = unit(p[at] - where)
                if world.readings.offset == "mitsuba":
                    p[at] = where + world.kind(thing.radius) * n[at]
            else:
                literal[at] = np.array(thing.normal, world.kind)
                n[at] = unit(literal[at])
        lit_by = literal if world.readings.plane_normal == "raw" else n
        return Hits(i, p, n, lit_by, -d, depth, inside_of)

    def shade(self, hits: Hits) -> tuple[Floats, Floats]:
        """Add up local + kr·reflected + kt·refracted, sending the two rays or not."""
        world, i = self.world, hits.i
        own, margin = local(world, hits)
        cosine = dot(hits.n, hits.wo)
        inner = cosine <= 0
        ratio = self.ratio(hits, inner)
        delta = 1 - (1 - cosine * cosine) / (ratio * ratio)
        asked = (world.kt[i] > 0) | ((world.readings.tir == "always") & (ratio != 1))
        margin = np.where(asked, np.fmin.reduce([margin, np.abs(delta), np.abs(cosine)]), margin)
        kr, kt = self.weights(i, inner, asked & (delta < 0))
        color = (1 - kr - kt)[:, None] * own if world.readings.mix == "convex" else own
        if hits.depth >= world.max_depth:
            if world.readings.exhausted == "background" and world.numbers.delivery == 3:
                color = color + (kr + kt)[:, None] * world.background
            return color, margin
        reflected = unit(2 * cosine[:, None] * hits.n - hits.wo)
        facing = np.where(inner[:, None], -hits.n, hits.n)
        bend = np.sqrt(np.maximum(delta, 0)) - np.abs(cosine) / ratio
        refracted = unit(-hits.wo / ratio[:, None] - bend[:, None] * facing)
        step = world.step * (world.readings.epsilon_for == "all")
        for weight, w, crossing in ((kr, reflected, False), (kt, refracted, True)):
            start = world.shifted(hits.p, hits.n, w, step)
            for sent, inside_of in self.groups(weight > 0, hits, inner, crossing):
                way, depth = w[sent], hits.depth + 1
                if crossing and self.passes(hits.inside_of, inside_of):
                    way, depth = -hits.wo[sent], hits.depth
                    start = world.shifted(hits.p, hits.n, -hits.wo, step)
                back, _, _, surely = self.trace(start[sent], way, depth, inside_of)
                color[sent] += weight[sent][:, None] * back
                margin[sent] = np.minimum(margin[sent], surely)
        return color, margin

    def weights(self, i: Floats, inner: Floats, total: Floats) -> tuple[Floats, Floats]:
        """Return kr and kt as they act, under total reflection where `total`."""
        world = self.world
        kr, kt = world.kr[i], world.kt[i]
        instead = {
            "full": np.ones_like(kr), "always": np.ones_like(kr), "ignore": kr, "add": kr + kt,
            "plus-one": kr + 1, "needs-kr": np.where(kr > 0, world.kind(1), 0),
        }[world.readings.tir]  # fmt: skip
        if world.readings.inner_reflection == "off":
            kr = np.where(inner & (kt > 0), 0, kr)
        return np.where(total, instead, kr), np.where(total, 0, kt)

    def ratio(self, hits: Hits, inner: Floats) -> Floats:
        """Index of the side that the ray goes to over that of the side it comes from."""
        world, i = self.world, hits.i
        if world.readings.nesting != "relative":
            found = np.empty(len(i), world.kind)
            for k in np.unique(i):
                leaves = self.leaves(hits, int(k), inner)
                for leaving in (False, True):
                    after = crossed(hits.inside_of, int(k), leaving)
                    change = self.index_in(after) / self.index_in(hits.inside_of)
                    found[(i == k) & (leaves == leaving)] = change
            return found
        n = 1 / world.n[i] if world.readings.refraction == "inverted" else world.n[i]
        return n if world.readings.refraction == "one-way" else np.where(inner, 1 / n, n)

    def leaves(self, hits: Hits, k: int, inner: Floats) -> Floats:
        """Say of each hit whether it leaves k: by its side, or by the list of interiors."""
        if self.world.readings.nesting == "interiors":
            return np.full(len(inner), k in hits.inside_of)
        return inner

    def index_in(self, inside_of: tuple[int, ...]) -> Floats:
        """Return the index of the last thing in the list; the world's is 1."""
        return self.world.n[inside_of[-1]] if inside_of else self.world.kind(1)

    def passes(self, before: tuple[int, ...], after: tuple[int, ...]) -> bool:
        """Say whether a crossing is no bounce."""
        change = self.index_in(after) / self.index_in(before) - 1
        return self.world.readings.nesting == "interiors" and bool(abs(change) < 1e-10)

    def groups(
        self, sent: Floats, hits: Hits, inner: Floats, crossing: bool
    ) -> list[tuple[Floats, tuple[int, ...]]]:
        """Return the rays to send and what they are then inside of; one group unless tracked."""
        if self.world.readings.nesting == "relative" or not crossing:
            return [(sent, hits.inside_of)] if sent.any() else []
        found = []
        for k in np.unique(hits.i[sent]):
            leaves = self.leaves(hits, int(k), inner)
            for leaving in (False, True):
                group = sent & (hits.i == k) & (leaves == leaving)
                if group.any():
                    found.append((group, crossed(hits.inside_of, int(k), leaving)))
        return found


def crossed(inside_of: tuple[int, ...], k: int, leaving: bool) -> tuple[int, ...]:
    """Return the things that a ray is in after it enters k, or leaves it where it last entered."""
    if not leaving:
        return (*inside_of, k)
    at = max((j for j, x in enumerate(inside_of) if x == k), default=len(inside_of))
    return inside_of[:at] + inside_of[at + 1 :]
