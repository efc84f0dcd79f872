"""Random small scenes: POV-Ray and native agree on all but tolerance contacts."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from crosstrace.translators.renderer import Rendering
from crosstrace.translators.scene import Scene, plane, sphere

#: Of 4800: a contact shadow below POV-Ray's tolerance, a plane beyond its farthest hit.
CONTACTS = 2


def material(random: np.random.Generator, glass: bool) -> dict[str, float]:
    stated = {"ka": random.uniform(0, 0.4), "kd": random.uniform(0, 0.8),
              "ks": random.uniform(0, 0.8) * (random.random() < 0.7),
              "eta": float(np.exp(random.uniform(-1, 6)))}  # fmt: skip
    if glass:
        stated |= {"kr": random.uniform(0, 0.4), "kt": float(random.choice([0.5, 0.9, 1.0])),
                   "n": float(random.choice([1.5, 1.33, 0.7, 1.0, 2.4]))}  # fmt: skip
    elif random.random() < 0.5:
        stated["kr"] = random.uniform(0, 0.9)
    return stated


def random_objects(random: np.random.Generator) -> list[dict[str, Any]]:
    """Return a floor, perhaps a wall, opaque balls, and glass balls that do not cross."""

    def color() -> list[float]:
        return [float(v) for v in random.uniform(0, 255, 3)]

    up = [0, 0, float(random.choice([1, -1]))]
    objects = [plane(color(), [0, 0, random.uniform(-1.5, -1)], up, **material(random, False))]
    if random.random() < 0.5:
        leaning = random.uniform(-1, 1, 3) + np.array([0, -2, 0])
        objects.append(plane(color(), [0, 5, 0], leaning.tolist(), **material(random, False)))
    for _ in range(random.integers(1, 5)):
        center = random.uniform(-2, 2, 3).tolist()
        objects.append(sphere(color(), center, random.uniform(0.2, 1), **material(random, False)))
    placed: list[tuple[Any, float]] = []
    for _ in range(12):
        center, radius = random.uniform(-2, 2, 3), random.uniform(0.2, 1)
        if placed and random.random() < 0.3:
            center, radius = placed[0][0] + random.uniform(-0.2, 0.2, 3), radius / 2
        if all((d := np.linalg.norm(center - c)) > radius + r or d < abs(radius - r)
               for c, r in placed):  # fmt: skip
            placed.append((center, radius))
            objects.append(sphere(color(), center.tolist(), radius, **material(random, True)))
    return [objects[i] for i in random.permutation(len(objects))]


@pytest.mark.parametrize(
    "seed", [*range(4), *(pytest.param(seed, marks=pytest.mark.slow) for seed in range(4, 60))]
)
def test_random_rooms_agree(
    seed: int,
    make_scene: Callable[..., Scene],
    beyond: Callable[[Scene], tuple[int, Rendering]],
) -> None:
    """At most the few pixels of a tolerance contact leave native's value."""
    random = np.random.default_rng(seed)
    lights = [(random.uniform(0, 255, 3), random.uniform(-4, 4, 3))
              for _ in range(random.integers(0, 4))]  # fmt: skip
    scene = make_scene(objects=random_objects(random), lights=lights, eye=[0.0, -5.0, 0.5],
                       max_depth=int(random.integers(0, 6)),
                       background=random.uniform(0, 255, 3))  # fmt: skip
    pixels, _ = beyond(scene)
    assert pixels <= CONTACTS
