"""Whitted's recursion as one symbolic loop over rays with an explicit stack.

Colours only add up, so nothing is returned from a ray to its parent: each ray carries the product
of the kr and kt above it, and adds its weighted colour to the pixel's sum. Where a hit spawns two
rays, one is followed and the other waits on the stack; there is at most one waiting ray a level.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import drjit as dr

#: Waiting rays that fit the stack, the same for every scene: Dr.Jit 1.5 leaves the size of local
#: memory out of a kernel's hash, and a kernel compiled for a smaller one would overrun its stack.
STACK = 128


@dataclass(frozen=True)
class Kinds:
    """The Dr.Jit types of one precision."""

    real: Any
    vector: Any
    color: Any
    index: Any


@dataclass(frozen=True)
class Ray:
    """A ray and what its colour counts for: origin and unit direction, (3, n) each, weight (n,)."""

    origin: Any
    direction: Any
    weight: Any


@dataclass(frozen=True)
class Step:
    """What one ray sees: its own colour (the background where it hits nothing) and its children.

    A child's weight is that of one bounce, and 0 where there is no such child; a child is None
    where the scene's effects call for none of its kind.
    """

    color: Any
    reflected: Ray | None
    refracted: Ray | None


#: (origin, direction, which rays are primary, which are traced) → Step
Tracer = Callable[[Any, Any, Any, Any], Step]


def radiance(
    kinds: Kinds, trace: Tracer, ray: tuple[Any, Any], active: Any,
    *, max_depth: Any, bounces: bool, branches: bool,
) -> Any:  # fmt: skip
    """Return the colour of each primary ray, (3, n).

    `bounces` says whether any hit spawns a ray and `branches` whether one can spawn two; both are
    known before tracing, so that the kernel holds no loop and no stack for scenes without.
    """
    origin, direction = ray
    width = dr.width(direction)
    if not bounces:
        color = trace(origin, direction, dr.full(dr.mask_t(active), True, width), active).color
        return dr.select(active, color, 0)

    stack = _Stack(kinds) if branches else None
    # Every state starts at full width: Dr.Jit 1.5 takes an index into local memory that starts at
    # width 1 for the same on all lanes, silently.
    state = (
        kinds.vector(origin), kinds.vector(direction), dr.ones(kinds.real, width),
        dr.zeros(kinds.index, width), dr.zeros(kinds.index, width),
        active & dr.full(dr.mask_t(active), True, width), dr.zeros(kinds.color, width),
        *(stack.buffers if stack else ()),
    )  # fmt: skip

    def body(o: Any, d: Any, weight: Any, depth: Any, waiting: Any, on: Any, total: Any,
             *buffers: Any) -> tuple[Any, ...]:  # fmt: skip
        step = trace(o, d, depth == 0, on)
        total = total + dr.select(on, weight * step.color, 0)
        weight = dr.select(on & (depth < max_depth), weight, 0)
        o, d, child, second = _children(step, weight)
        depth = depth + 1
        if stack is not None and second is not None:
            waiting = stack.push(buffers, waiting, second, depth)
        alive = child > 0
        if stack is not None:
            pop = ~alive & (waiting > 0)
            waiting = dr.select(pop, waiting - 1, waiting)
            o, d, child, depth = stack.top(buffers, waiting, pop, (o, d, child, depth))
            alive |= pop
        return (o, d, child, depth, waiting, alive, total, *buffers)

    result = dr.while_loop(state, lambda *s: s[5], body, label="whitted")
    return result[6]


def _children(step: Step, weight: Any) -> tuple[Any, Any, Any, Ray | None]:
    """Pick the ray to follow (origin, direction, weight) and the one that waits, if any."""
    mirror, glass = step.reflected, step.refracted
    if mirror is None or glass is None:
        only = mirror or glass
        assert only is not None
        return only.origin, only.direction, weight * only.weight, None
    first, second = weight * mirror.weight, weight * glass.weight
    both, follow = (first > 0) & (second > 0), first > 0
    waits = Ray(glass.origin, glass.direction, dr.select(both, second, 0))
    return (
        dr.select(follow, mirror.origin, glass.origin),
        dr.select(follow, mirror.direction, glass.direction),
        dr.select(follow, first, second),
        waits,
    )


class _Stack:
    """Waiting rays in the local memory of each lane; push and top take the loop's own buffers."""

    def __init__(self, kinds: Kinds) -> None:
        types = (kinds.vector, kinds.vector, kinds.real, kinds.index)
        self.buffers = tuple(dr.alloc_local(kind, STACK) for kind in types)

    def push(self, buffers: Any, waiting: Any, ray: Ray, depth: Any) -> Any:
        # The literal keeps the capacity in the kernel's text, and so in its hash.
        where = (ray.weight > 0) & (waiting < STACK)
        values = (ray.origin, ray.direction, ray.weight, depth)
        for buffer, value in zip(buffers, values, strict=True):
            buffer.write(value, waiting, where)
        return dr.select(where, waiting + 1, waiting)

    def top(self, buffers: Any, waiting: Any, where: Any, otherwise: Any) -> tuple[Any, ...]:
        pairs = zip(buffers, otherwise, strict=True)
        return tuple(dr.select(where, b.read(waiting, where), value) for b, value in pairs)
