"""The scene in Dr.Jit Float64: what one ray sees, by the specification's own rules (ε = 1e-5)."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from typing import Any

import drjit as dr
import mitsuba as mi
import numpy as np

from crosstrace.translators.mitsuba import shading
from crosstrace.translators.mitsuba.camera import Array
from crosstrace.translators.mitsuba.exact_surfaces import NONE, Hit, Surfaces
from crosstrace.translators.mitsuba.recursion import Kinds, Ray, Step

#: Shadow and secondary rays start this far along their direction (3.3).
EPSILON = 1e-5


@dataclass(frozen=True)
class Materials:
    """Per object: colour in 0…1 (k, 3) and ka kd ks η kr kt n, the columns of (k, 7)."""

    color: Array
    coefficients: Array


@dataclass(frozen=True)
class Lighting:
    """Colours in 0…1: ambient light and background (3,), point lights (m, 3) with their places."""

    ambient: Array
    background: Array
    colors: Array
    positions: Array


class ExactWorld:
    """Traces Float64 rays; only the effects asked for are put into the kernel."""

    kinds = Kinds(mi.Float64, mi.Vector3d, mi.Vector3d, mi.UInt32)

    def __init__(
        self, surfaces: Surfaces, materials: Materials, lighting: Lighting,
        effects: Collection[str],
    ) -> None:  # fmt: skip
        """Upload the tables; `effects` are names of `effects.py`."""
        self._surfaces = surfaces
        self._effects = frozenset(effects)
        self._color = _table(materials.color)
        self._coefficients = _table(materials.coefficients)
        self._ambient = dr.opaque(mi.Vector3d, lighting.ambient.tolist())
        self._background = dr.opaque(mi.Vector3d, lighting.background.tolist())
        self._light_color = _table(lighting.colors)
        self._light_position = _table(lighting.positions)
        self._lights = dr.opaque(mi.UInt32, len(lighting.colors))

    def trace(self, origin: Any, direction: Any, primary: Any, active: Any) -> Step:
        """Return what each ray sees (`recursion.Tracer`)."""
        hit = self._surfaces.nearest(origin, direction, primary, active)
        on = active & (hit.index != NONE)
        color = dr.gather(mi.Vector3d, self._color, hit.index, on)
        towards = -direction
        local = self._local(hit, towards, color, on)
        mirror, glass = self._children(hit, towards, on)
        return Step(dr.select(on, local, self._background), mirror, glass)

    def _coefficient(self, hit: Hit, column: int, on: Any) -> Any:
        return dr.gather(mi.Float64, self._coefficients, hit.index * 7 + column, on)

    def _local(self, hit: Hit, towards: Any, color: Any, on: Any) -> Any:
        """Return the colour of 3.2, or the object's own colour in the first delivery."""
        if "flat" in self._effects:
            return color
        total = dr.zeros(mi.Vector3d, dr.width(color))
        if "ambient" in self._effects:
            total = total + self._coefficient(hit, 0, on) * color * self._ambient
        diffuse, specular = ("diffuse" in self._effects), ("specular" in self._effects)
        if not (diffuse or specular):
            return total
        kd_color = self._coefficient(hit, 1, on) * color if diffuse else None
        ks, eta = (self._coefficient(hit, k, on) if specular else None for k in (2, 3))

        def body(j: Any, total: Any) -> Any:
            light = dr.gather(mi.Vector3d, self._light_position, j, on)
            apart = light - hit.point
            distance = dr.norm(apart)
            to_light = apart / distance
            share = dr.zeros(mi.Vector3d, dr.width(total))
            if kd_color is not None:
                share += kd_color * shading.positive(dr.dot(hit.normal, to_light))
            if ks is not None:
                mirrored = shading.mirrored(to_light, hit.normal)
                share += ks * shading.power_of_cosine(mirrored, towards, eta)
            lit = on & dr.any(share > 0)
            if "shadows" in self._effects:
                start = dr.fma(to_light, EPSILON, hit.point)
                # From there the light is ε nearer; one within ε of the point is never blocked.
                left = distance - EPSILON
                lit &= ~self._surfaces.blocked(start, to_light, light, left, lit)
            share *= dr.gather(mi.Vector3d, self._light_color, j, on)
            return j + 1, total + dr.select(lit, share, 0)

        state = (dr.zeros(mi.UInt32, dr.width(total)), total)
        return dr.while_loop(state, lambda j, _: on & (j < self._lights), body, label="lights")[1]

    def _children(self, hit: Hit, towards: Any, on: Any) -> tuple[Ray | None, Ray | None]:
        """Return the reflected and the refracted ray of 4.1 and 4.2, None where not called for."""
        asked = {name: name in self._effects for name in ("reflection", "refraction")}
        total = "total_reflection" in self._effects
        mirror = glass = None
        kr = self._coefficient(hit, 4, on) if asked["reflection"] else mi.Float64(0)
        if asked["refraction"] or total:
            kt, index = self._coefficient(hit, 5, on), self._coefficient(hit, 6, on)
            m, delta, along = shading.bend(dr.dot(hit.normal, towards), index)
            if total:
                kr = dr.select((kt > 0) & (delta < 0), 1, kr)
            if asked["refraction"]:
                way = -m * towards - along * hit.normal
                weight = dr.select(on & (delta >= 0), kt, 0)
                glass = Ray(dr.fma(way, EPSILON, hit.point), way, weight)
        if asked["reflection"] or total:
            way = shading.mirrored(towards, hit.normal)
            mirror = Ray(dr.fma(way, EPSILON, hit.point), way, dr.select(on, kr, 0))
        return mirror, glass


def _table(values: Array) -> Any:
    """Upload a table row by row; an empty one holds one unused row."""
    rows = values if len(values) else np.zeros((1, *values.shape[1:]))
    return mi.Float64(np.ascontiguousarray(rows).ravel())
