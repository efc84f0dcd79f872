"""The oracle's light: Phong's sum over the lights that are not blocked, and its shadow rays."""

from __future__ import annotations

from typing import Any

import numpy as np
from oracle_surfaces import SHADOW_EPSILON, blocked, dot, unit
from oracle_world import Hits, World

Floats = Any


def local(world: World, hits: Hits) -> tuple[Floats, Floats]:
    """Return (colour, margin): ka·cd∗ca + Σ kd·cd∗max(0, n·l)·cⱼ + Σ ks·max(0, r·ωo)^η·cⱼ."""
    i, lit_by, seen_from = hits.i, hits.lit_by, hits.wo
    margin = np.full(len(i), np.inf, world.kind)
    if world.readings.lighting_normal == "facing":
        side = dot(hits.n, hits.wo)
        lit_by = np.where((side < 0)[:, None], -lit_by, lit_by)
        margin = np.abs(side)
    if world.readings.view == "eye" and hits.depth:
        seen_from = unit(world.eye - hits.p)
    diffuse = world.ka[i][:, None] * world.color[i] * world.ambient
    specular = np.zeros_like(diffuse)
    for color, position in world.lights:
        to_light = unit(position - hits.p)
        cosine = dot(lit_by, to_light)
        shine = np.maximum(0, dot(2 * cosine[:, None] * lit_by - to_light, seen_from))
        if world.readings.specular_gate == "lit":
            sharp = (world.ks[i] > 0) & (shine > 0)
            margin = np.where(sharp, np.minimum(margin, np.abs(cosine)), margin)
            shine = np.where(cosine > 0, shine, 0)
        soft = world.kd[i] * np.maximum(0, cosine)
        power = np.where(shine > 0, shine, 1) ** world.eta[i]
        hard = world.ks[i] * np.where(shine > 0, power, 0)
        matters = (soft > 0) | (hard > 0)
        shadow, surely = in_shadow(world, hits, position, matters)
        margin = np.where(matters, np.minimum(margin, surely), margin)
        diffuse += np.where(shadow, 0, soft)[:, None] * world.color[i] * color
        specular += np.where(shadow, 0, hard)[:, None] * color
    return diffuse + specular, margin


def in_shadow(world: World, hits: Hits, light: Floats, wanted: Floats) -> tuple[Floats, Floats]:
    """Return (blocked, margin), seen from the shifted point; points not wanted stay unblocked."""
    shadow = np.zeros(len(wanted), bool)
    margin = np.full(len(wanted), np.inf, world.kind)
    if not wanted.any():
        return shadow, margin
    towards = light - hits.p[wanted]
    start = world.shifted(hits.p[wanted], hits.n[wanted], unit(towards), world.step)
    limit = np.sqrt(dot(light - start, light - start))
    d = unit(light - start)
    if world.readings.offset == "direction":
        # ε may reach past the light: then nothing lies between, and l keeps its direction.
        limit = np.sqrt(dot(towards, towards)) - world.step
        d = unit(towards)
    reach = limit
    if world.readings.offset == "mitsuba":
        limit = limit * (1 - SHADOW_EPSILON)
    if world.readings.light_min:
        limit = np.minimum(limit, reach - world.readings.light_min)
    if world.readings.shadow_distance == "ignored":
        limit = np.full_like(limit, np.inf)
    clear = world.readings.glass_shadow == "clear"
    things = [thing for thing in world.things if not (clear and thing.kt > 0)]
    if world.far < np.inf:
        limit = np.minimum(limit, np.nextafter(world.kind(world.far), np.inf))
    shadow[wanted], margin[wanted] = blocked(things, start, d, world.readings.shadow_min, limit)
    return shadow, margin
