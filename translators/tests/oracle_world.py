"""What the oracle holds of a scene: constant arrays in its arithmetic, the camera, the shift.

Vectors are (3,) or (m, 3), colours on the scale 0…1.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from oracle_readings import Readings
from oracle_scene import Numbers
from oracle_surfaces import RAY_EPSILON, dot, lies_on, unit

Floats = Any


@dataclass(frozen=True)
class Hits:
    """Where a batch of rays met things `i`: point, unit normal, the normal to light by, ωo."""

    i: Floats
    p: Floats
    n: Floats
    lit_by: Floats
    wo: Floats
    depth: int
    inside_of: tuple[int, ...]


class World:
    """A scene's numbers and readings, ready to trace in arithmetic `kind`."""

    def __init__(self, numbers: Numbers, kind: Any, readings: Readings) -> None:
        """Convert every number once."""
        self.numbers, self.kind, self.readings = numbers, kind, readings
        self.things = numbers.things
        self.eye = np.array(numbers.eye, kind)
        self.background = np.array(numbers.background, kind) / 255
        self.ambient = np.array(numbers.ambient, kind) / 255
        self.lights = [(np.array(c, kind) / 255, np.array(p, kind)) for c, p in numbers.lights]
        self.color = np.array([x.color for x in self.things], kind).reshape(-1, 3) / 255
        self.ka, self.kd, self.ks, self.eta, self.kr, self.kt, self.n = (
            np.array([getattr(x, name) for x in self.things], kind)
            for name in ("ka", "kd", "ks", "eta", "kr", "kt", "n")
        )
        # Without refraction n means nothing and may be 0: any positive number serves.
        self.n = np.where(self.n > 0, self.n, 1)
        if readings.index == "float32":
            single = self.n.astype(np.float32)
            above = np.nextafter(np.float32(1), np.float32(2))
            self.n = np.where(single == 1, above, single).astype(kind)
        self.on_surface = [lies_on(numbers.eye, thing) for thing in self.things]
        change = {"as-given": 0, "minus-one": -1, "plus-one": 1}[readings.depth]
        self.max_depth = max(0, numbers.max_depth + change) if numbers.delivery == 3 else 0
        self.far = readings.far or np.inf
        self.step = kind(readings.epsilon * (2 if readings.epsilon_twice == "yes" else 1))
        self.w = unit(self.eye - np.array(numbers.target, kind))
        self.u = unit(np.cross(np.array(numbers.up, kind), self.w))
        self.v = np.cross(self.w, self.u)

    def around_eye(self) -> tuple[int, ...]:
        """Return the transparent things around the eye, outermost first, if nesting is tracked."""
        if self.readings.nesting == "relative":
            return ()
        found = []
        for k, thing in enumerate(self.things):
            away = self.eye - np.array(thing.where, self.kind)
            normal = np.array(thing.normal, self.kind)
            inner = dot(away, away) - thing.radius**2 if thing.sphere else dot(away, normal)
            if thing.kt > 0 and inner < 0:
                found.append(k)
        return tuple(sorted(found, key=lambda k: -(self.things[k].radius or np.inf)))

    def directions(self) -> Floats:
        """Unit vectors from E through the pixel centres, (v_res, h_res, 3), as 2.3 has them."""
        x = self.numbers
        s, half = self.kind(x.s), self.kind(0.5)
        across = s * (np.arange(x.h_res) - self.kind(x.h_res) / 2 + half)
        down = -s * (np.arange(x.v_res) - self.kind(x.v_res) / 2 + half)
        q = across[None, :, None] * self.u + down[:, None, None] * self.v
        return unit(q - self.kind(x.d) * self.w)

    def shifted(self, p: Floats, n: Floats, w: Floats, step: Floats) -> Floats:
        """Where a ray that leaves p, a point with the normal n, in the direction w starts."""
        if self.readings.offset == "direction":
            return p + step * w
        if self.readings.offset == "mitsuba":
            step = (1 + np.abs(p).max(axis=-1)) * RAY_EPSILON
        return p + (np.copysign(1, dot(n, w)) * step)[:, None] * n
