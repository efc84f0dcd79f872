"""POV-Ray follows the specification in every situation where its own habits differ.

Each scene is the smallest that shows one of them; native is what they are compared with.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from crosstrace.translators.renderer import Rendering
from crosstrace.translators.scene import Scene, plane, sphere

MATT = {"ka": 0.2, "kd": 0.6, "ks": 0.3, "eta": 20.0}
GLASS = {"ka": 0.05, "kd": 0.1, "ks": 0.4, "eta": 60.0, "kr": 0.15, "kt": 0.8, "n": 1.5}
MIRROR = {"ka": 0.1, "kd": 0.2, "ks": 0.2, "eta": 30.0, "kr": 0.7}

FLOOR = plane([120, 200, 90], [0, 0, 0], [0, 0, 1], **MATT)
BALL = sphere([220, 60, 40], [0.7, 1.2, 0.6], 0.6, **MATT)
BACK = sphere([90, 120, 230], [-0.9, 1.5, 0.9], 0.8, **MIRROR)
SUN = ([180, 180, 170], [-2.0, -3.0, 4.0])
LAMP = ([90, 110, 140], [3.0, -2.0, 5.0])

#: 300 places on a jittered lattice, so that spheres of radius 0.15 stay apart.
CROWD = np.stack(np.unravel_index(np.arange(300), (10, 10, 3)), axis=1) * 0.5 + (
    np.array([-2.3, -0.6, 0.3]) + np.random.default_rng(5).uniform(-0.09, 0.09, (300, 3))
)


def glass(center: list[float], radius: float, **changes: float) -> dict[str, Any]:
    return sphere([200, 240, 220], center, radius, **{**GLASS, **changes})


SITUATIONS: dict[str, dict[str, Any]] = {
    "diffuse, highlight and shadow": {"objects": [FLOOR, BALL, BACK], "lights": [SUN, LAMP]},
    "glass before a room": {
        "objects": [FLOOR, BALL, BACK, glass([0.1, -0.8, 0.8], 0.6)], "lights": [SUN, LAMP],
    },
    "a plane seen from its back": {
        "objects": [plane([120, 200, 90], [0, 0, 0], [0, 0, -1], **MATT), BALL], "lights": [SUN],
    },
    "a plane seen from its back with lights on both sides": {
        "objects": [plane([120, 200, 90], [0, 0, 0], [0, 0.1, -1], **MATT), BALL],
        "lights": [SUN, ([200, 150, 150], [0.5, 1.0, -2.0])],
    },
    "a plane lit from behind": {
        "objects": [FLOOR], "lights": [([250, 250, 250], [0.3, 1.0, -2.0])],
    },
    "a plane lit from both sides, with glass": {
        "objects": [FLOOR, BALL, glass([0.0, -0.6, 0.9], 0.7)],
        "lights": [SUN, ([250, 250, 250], [0.3, 3.0, -1.0]), ([80, 80, 99], [0.0, -0.6, 1.1])],
    },
    "a single plane lit from both sides": {
        "objects": [FLOOR], "lights": [SUN, ([250, 250, 250], [0.3, 3.0, -1.0])],
    },
    "inside a sphere with the light outside": {
        "objects": [sphere([200, 180, 90], [0, 0, 0], 9.0, **MATT), BALL],
        "lights": [([255, 255, 255], [0.0, -20.0, 3.0])],
    },
    "inside a sphere with the light inside": {
        "objects": [sphere([200, 180, 90], [0, 0, 0], 9.0, **MATT), BALL], "lights": [SUN],
    },
    "inside a mirror sphere with lights on both sides": {
        "objects": [sphere([200, 180, 90], [0, 0, 0], 9.0, **MIRROR), BALL],
        "lights": [SUN, ([255, 255, 255], [0.0, -20.0, 3.0])],
    },
    "a light inside an opaque sphere": {
        "objects": [FLOOR, sphere([255, 220, 90], [0, 0.5, 1], 0.7, **MATT), BALL],
        "lights": [([255, 255, 255], [0.0, 0.4, 1.1]), LAMP],
    },
    "a light inside glass": {
        "objects": [FLOOR, BALL, glass([0, 0, 1], 0.9)],
        "lights": [([255, 255, 255], [0.2, 0.1, 1.2]), LAMP],
    },
    "a plane of glass": {
        "objects": [plane([200, 220, 255], [0, 0, 0.3], [0, 0, 1], **{**GLASS, "n": 1.33}),
                    plane([120, 200, 90], [0, 0, -1], [0, 0, 1], **MATT), BALL],
        "lights": [SUN],
    },
    "a sphere of glass below a plane of glass": {
        "objects": [plane([200, 220, 255], [0, 0, 0.8], [0.1, 0, 1], **{**GLASS, "n": 1.33}),
                    plane([120, 200, 90], [0, 0, -1], [0, 0, 1], **MATT),
                    glass([0.2, 0.8, 0.1], 0.4), glass([-0.3, -1.0, 1.7], 0.4)],
        "lights": [SUN, LAMP],
    },
    "two planes of glass, one below the other": {
        "objects": [plane([200, 220, 255], [0, 0, 0.6], [0, 0, 2], **{**GLASS, "n": 1.33}),
                    plane([255, 220, 200], [0, 0, 0.1], [0, 0, -1], **{**GLASS, "n": 0.8}),
                    plane([120, 200, 90], [0, 0, -1], [0, 0, 1], **MATT)],
        "lights": [SUN],
    },
    "a bubble in glass": {
        "objects": [FLOOR, BALL, glass([0, 0, 0.9], 0.9), glass([0.1, 0, 1], 0.5, n=0.6667)],
        "lights": [SUN, LAMP],
    },
    "three spheres of glass in each other": {
        "objects": [FLOOR, BALL, glass([0, 0, 0.9], 0.9), glass([0.1, 0, 1], 0.6, n=1.2),
                    glass([0, 0.1, 1], 0.3, n=0.7)],
        "lights": [SUN],
    },
    "a camera inside glass": {
        "objects": [FLOOR, BALL, glass([0, -4, 1], 0.8), glass([0.3, 0, 1], 0.5)], "lights": [SUN],
    },
    "a camera inside a bubble inside glass": {
        "objects": [FLOOR, BALL, glass([0, -4, 1], 1.5), glass([0.1, -4, 1], 0.8, n=0.7),
                    glass([0.3, 0, 1], 0.5)],
        "lights": [SUN],
    },
    "a camera under a plane of glass": {
        "objects": [plane([200, 220, 255], [0, 0, 1.6], [0, 0, 1], **{**GLASS, "n": 1.33}),
                    FLOOR, BALL, glass([0.3, 0, 0.8], 0.5), glass([0.3, 0.1, 0.8], 0.2, n=0.8),
                    glass([-0.8, 2, 2.4], 0.5)],
        "lights": [SUN],
    },
    "a camera on a plane of glass, looking in": {
        "eye": [0, -4, 2], "target": [0, 0, 0],
        "objects": [plane([200, 220, 255], [0, -4, 2], [0, -0.5, 1], **{**GLASS, "n": 1.33}),
                    FLOOR, BALL, glass([0.1, 0, 0.8], 0.5)],
        "lights": [SUN],
    },
    "a camera on a plane of glass, looking out": {
        "eye": [0, -4, 2], "target": [0, 0, 0],
        "objects": [plane([200, 220, 255], [0, -4, 2], [0, 0.5, -1], **{**GLASS, "n": 1.33}),
                    FLOOR, BALL, glass([0.1, 0, 0.8], 0.5)],
        "lights": [SUN],
    },
    "a camera exactly on walls": {
        "objects": [FLOOR, BALL, plane([99, 99, 200], [0, -4, 0], [0, 1, 0], **MIRROR),
                    plane([199, 99, 200], [0, 4, 0], [0, -1, 0], **MIRROR)],
        "lights": [SUN],
    },
    "kt = 1 with its own ambient and diffuse light": {
        "objects": [FLOOR, BALL, glass([0, -0.5, 0.9], 0.8, ka=0.3, kd=0.5, kr=0.5, kt=1.0)],
        "lights": [SUN, LAMP],
    },
    "n = 1": {
        "objects": [FLOOR, BALL, glass([0.03, -0.5, 0.9], 0.8, n=1.0)], "lights": [SUN],
    },
    "n = 1 inside n = 1 inside n = 1": {
        "objects": [FLOOR, BALL, glass([0.03, -0.5, 0.9], 0.9, n=1.0),
                    glass([0.05, -0.5, 0.93], 0.6, n=1.0), glass([0.05, -0.4, 0.9], 0.4, n=1.0)],
        "lights": [SUN],
    },
    "n below 1": {
        "objects": [FLOOR, BALL, glass([0, -0.5, 0.9], 0.8, n=0.7)], "lights": [SUN],
    },
    "an exponent below 1": {
        "objects": [FLOOR, sphere([200, 90, 90], [0, 1, 1], 0.9, **{**MATT, "eta": 0.3})],
        "lights": [SUN],
    },
    "an exponent of 5000": {
        "objects": [FLOOR, sphere([200, 90, 90], [0, 1, 1], 0.9, **{**MATT, "eta": 5000.0})],
        "lights": [SUN],
    },
    "depth 0 with glass and mirrors": {
        "max_depth": 0, "lights": [SUN],
        "objects": [FLOOR, BACK, glass([0.1, -0.8, 0.8], 0.6)],
    },
    "depth 1 with glass and mirrors": {
        "max_depth": 1, "lights": [SUN],
        "objects": [FLOOR, BACK, glass([0.1, -0.8, 0.8], 0.6)],
    },
    "parallel mirrors at depth 200": {
        "max_depth": 200, "lights": [SUN], "target": [0.3, 0, 0.8],
        "objects": [plane([200, 90, 90], [0, 5.1, 0], [0, -1, 0], ka=0.01, kr=0.99),
                    plane([90, 90, 200], [0, -5.2, 0], [0, 1, 0], ka=0.01, kr=0.99), BALL],
    },
    "parallel mirrors whose depth no longer matters": {
        "max_depth": 1000, "lights": [SUN], "target": [0.3, 0, 0.8],
        "objects": [plane([200, 90, 90], [0, 5.1, 0], [0, -1, 0], ka=0.1, kr=0.8),
                    plane([90, 90, 200], [0, -5.2, 0], [0, 1, 0], ka=0.1, kr=0.8), BALL],
    },
    "glass and a perfect mirror at a depth that is never reached": {
        "max_depth": 5000, "lights": [SUN],
        "objects": [glass([0.1, -0.8, 0.8], 0.6, kr=0.0), FLOOR,
                    sphere([9, 99, 200], [0, 2, 1], 1, kr=1.0)],
    },
    "views along edges that spheres and planes touch at": {
        "eye": [0, -6, 1], "target": [0, 0, 1], "lights": [SUN, LAMP],
        "objects": [FLOOR, sphere([220, 60, 40], [-1, 0, 1], 1.0, **MATT), glass([1, 0, 1], 1.0),
                    sphere([20, 160, 40], [0, 1.5, 1.25], 0.75, **MIRROR),
                    plane([99, 99, 200], [0, 3, 0], [0, -1, 0], **MATT)],
    },
    "a light as far as the sun": {
        "objects": [FLOOR, BALL, BACK, glass([0.1, -0.8, 0.8], 0.6)],
        "lights": [([255, 250, 240], [-4e6, -9e6, 2e7])],
    },
    "300 spheres, some of glass and some in mirrors": {
        "lights": [SUN, LAMP],
        "objects": [FLOOR, *(
            glass(CROWD[i].tolist(), 0.15) if i % 5 == 0
            else sphere([i % 256, 255 - i % 200, 90], CROWD[i].tolist(), 0.15,
                        **(MIRROR if i % 3 else MATT))
            for i in range(300)
        )],
    },
    "more light than white": {
        "objects": [sphere([255, 255, 255], [0, 0, 0.8], 1.0, ka=1.0, kd=1.0, ks=1.0, eta=4.0)],
        "lights": [([255, 255, 255], [-2, -4, 3]), ([255, 255, 255], [-2, -4, 2])] * 3,
        "background": [255, 255, 255],
    },
    "coincident surfaces": {
        "objects": [glass([0.1, -0.8, 0.8], 0.6), BALL, FLOOR,
                    plane([250, 0, 0], [1, 2, 0], [0, 0, -3], **MIRROR),
                    sphere([0, 255, 0], [0.7, 1.2, 0.6], 0.6, **GLASS),
                    sphere([255, 0, 0], [0.1, -0.8, 0.8], 0.6, **MATT)],
        "lights": [SUN],
    },
    "no objects": {"lights": [SUN]},
    "no lights": {"objects": [FLOOR, BACK, glass([0.1, -0.8, 0.8], 0.6)]},
    "one pixel": {"objects": [FLOOR, BALL, BACK], "lights": [SUN], "v_res": 1, "h_res": 1},
    "an odd frame and a tilted camera": {
        "objects": [FLOOR, BALL, BACK], "lights": [SUN], "v_res": 37, "h_res": 83,
        "up": [0.3, 0.2, 0.9],
    },
    "flat colours inside a sphere and behind a plane": {
        "delivery": 1, "max_depth": 0, "ambient": [255.0, 255.0, 255.0], "eye": [0, 0, 0.9],
        "target": [0, 1, 1.3],
        "objects": [sphere([200, 10, 30], [0, 0, 1], 1.0), plane([1, 2, 3], [0, 0, 2], [0, 0, 1])],
    },
    "flat colours": {
        "delivery": 1, "max_depth": 0, "ambient": [255.0, 255.0, 255.0],
        "objects": [sphere([200, 10, 30], [0, 0, 1], 1.0), plane([1, 2, 3], [0, 0, 0], [0, 0, 1])],
    },
    "Phong without secondary rays": {
        "delivery": 2, "max_depth": 0, "objects": [FLOOR, BALL], "lights": [SUN, LAMP],
    },
}  # fmt: skip


@pytest.mark.parametrize("situation", SITUATIONS)
def test_every_pixel_is_native_s(
    situation: str,
    make_scene: Callable[..., Scene],
    beyond: Callable[[Scene], tuple[int, Rendering]],
) -> None:
    """No pixel departs from native by more than the output's quantisation and 1e-5."""
    pixels, _ = beyond(make_scene(**SITUATIONS[situation]))
    assert pixels == 0
