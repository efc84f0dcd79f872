"""The oracle's own minimal reader of the course format, and the plain numbers that it traces.

It trusts its input: malformed files are the parser's business, not the oracle's. Colours are kept
on the file's scale 0…255, lengths in world units.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

Vector = tuple[float, float, float]


@dataclass(frozen=True)
class Thing:
    """One object: `where` is a sphere's centre or a plane's point, `normal` a plane's, as given."""

    sphere: bool
    color: Vector
    where: Vector
    radius: float = 0.0
    normal: Vector = (0.0, 0.0, 0.0)
    ka: float = 0.0
    kd: float = 0.0
    ks: float = 0.0
    eta: float = 1.0
    kr: float = 0.0
    kt: float = 0.0
    n: float = 1.0

    @property
    def shape(self) -> tuple[Any, ...]:
        """The surface alone: two objects with the same shape tie at every ray."""
        return self.sphere, self.where, self.radius, self.normal


@dataclass(frozen=True)
class Numbers:
    """A whole scene as plain numbers; `lights` are (colour, position)."""

    delivery: int
    v_res: int
    h_res: int
    s: float
    d: float
    eye: Vector
    target: Vector
    up: Vector
    background: Vector
    max_depth: int = 0
    things: list[Thing] = field(default_factory=list)
    ambient: Vector = (0.0, 0.0, 0.0)
    lights: list[tuple[Vector, Vector]] = field(default_factory=list)


def read(text: str) -> Numbers:
    """Read a well-formed scene of any delivery; the number of columns tells which."""
    tokens = text.lstrip("\ufeff").split()
    before = next((i for i, token in enumerate(tokens) if token in "*/"), None)
    if before is None:
        count = len(tokens) - 16
        delivery = 1 if count == 1 else 2 if count % 6 == 5 else 3
    else:
        delivery = {20: 1, 24: 2, 28: 3}[before]
    rest = iter(tokens)

    def number() -> float:
        return float(next(rest))

    def vector() -> Vector:
        return number(), number(), number()

    v_res, h_res = int(number()), int(number())
    s, d = number(), number()
    eye, target, up, background = vector(), vector(), vector(), vector()
    max_depth = int(number()) if delivery == 3 else 0
    things = []
    for _ in range(int(number())):
        color = vector()
        columns = {1: "", 2: "ka kd ks eta", 3: "ka kd ks eta kr kt n"}[delivery].split()
        material = {name: number() for name in columns}
        if next(rest) == "*":
            things.append(Thing(True, color, vector(), number(), **material))
        else:
            things.append(Thing(False, color, vector(), 0.0, vector(), **material))
    ambient: Vector = (0.0, 0.0, 0.0)
    lights = []
    if delivery > 1:
        ambient = vector()
        lights = [(vector(), vector()) for _ in range(int(number()))]
    return Numbers(
        delivery, v_res, h_res, s, d, eye, target, up, background,
        max_depth, things, ambient, lights,
    )  # fmt: skip


def plain(scene: Any) -> Numbers:
    """Take the plain numbers out of anything that has a Scene's attributes."""

    def vector(values: Any) -> Vector:
        x, y, z = (float(value) for value in values)
        return x, y, z

    things = []
    for kind, color, material, geometry in zip(
        scene.kind, scene.color, scene.material, scene.geometry, strict=True
    ):
        names = ("ka", "kd", "ks", "eta", "kr", "kt", "n")
        stated = {name: float(value) for name, value in zip(names, material, strict=True)}
        first, last = vector(geometry[:3]), geometry[3:]
        if kind == 0:
            things.append(Thing(True, vector(color), first, float(last[0]), **stated))
        else:
            things.append(Thing(False, vector(color), first, 0.0, vector(last), **stated))
    return Numbers(
        int(scene.delivery), int(scene.v_res), int(scene.h_res),
        float(scene.pixel_size), float(scene.screen_distance),
        vector(scene.eye), vector(scene.target), vector(scene.up), vector(scene.background),
        int(scene.max_depth), things, vector(scene.ambient),
        [(vector(light[:3]), vector(light[3:])) for light in scene.lights],
    )  # fmt: skip
