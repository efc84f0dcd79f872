"""Small random scenes with every effect in them, for the comparison of two tracers."""

from __future__ import annotations

import numpy as np

from crosstrace.translators.scene import Scene, plane, sphere


def random_scene(seed: int, delivery: int = 3, max_depth: int | None = None) -> Scene:
    """Return spheres, planes and lights at 24 × 32 pixels; the same scene for the same seed.

    A third of the things is matte, a third may be mirrors, a third glass with n on both sides of 1;
    some eyes are inside glass, some on a plane, and plane normals have any length.
    """
    rng = np.random.default_rng([seed, delivery])

    def material() -> dict[str, float]:
        stated = {
            "ka": rng.uniform(0, 0.4), "kd": rng.uniform(0, 0.9),
            "ks": rng.choice([0, rng.uniform(0, 1)]), "eta": rng.choice([1, 2.5, 10, 40, 150.0]),
        }  # fmt: skip
        if delivery == 3:
            kind = rng.integers(3)
            stated["kr"] = rng.choice([0, rng.uniform(0, 0.8)]) if kind else 0
            stated["kt"] = rng.uniform(0.3, 1) if kind == 2 else 0
            stated["n"] = rng.choice([rng.uniform(0.5, 0.95), rng.uniform(1.05, 2.2)])
        return {name: float(value) for name, value in stated.items()} if delivery > 1 else {}

    things = []
    for _ in range(rng.integers(2, 6)):
        centre = rng.uniform([-3, -2, -1.5], [3, 3, 2.5])
        things.append(sphere(rng.integers(0, 256, 3), centre, rng.uniform(0.3, 1.5), **material()))
    eye = np.array([rng.uniform(-1.5, 1.5), -7.3, rng.uniform(-0.5, 1.5)])
    if seed % 5 == 3:
        things.append(sphere((10, 20, 30), eye + 0.11, 0.83, **material()))
    for _ in range(rng.integers(1, 4)):
        normal = rng.normal(size=3)
        # Away from the middle, and mostly with the normal towards it.
        point = -normal / np.linalg.norm(normal) * rng.uniform(3, 6)
        normal *= rng.choice([1, 1, -1]) * rng.uniform(0.3, 2)
        things.append(plane(rng.integers(0, 256, 3), point, normal, **material()))
    if seed % 5 == 4:
        things.append(plane((90, 120, 60), (0, -7.3, 1), (0, 0.5, 0), **material()))
    lights = [
        (rng.uniform(30, 255, 3), rng.uniform([-4, -6, 0], [4, 2, 5]))
        for _ in range(rng.integers(1, 4) if delivery > 1 else 0)
    ]
    depth = int(rng.integers(0, 6)) if max_depth is None else max_depth
    return Scene.build(
        delivery=delivery, v_res=24, h_res=32, pixel_size=0.03, screen_distance=0.9,
        eye=eye, target=rng.uniform(-0.5, 0.5, 3), up=(0.1, 0.2, 1.3),
        background=rng.integers(0, 256, 3), max_depth=depth if delivery == 3 else 0,
        objects=things, lights=lights,
        ambient=rng.integers(0, 256, 3) if delivery > 1 else (255, 255, 255),
    )  # fmt: skip
