"""The oracle's readings: names, values and defaults, and what it takes each of them to mean.

Where the table of readings leaves room, the oracle takes the plainest meaning:

- `view=eye`: in lighting only (r·ωo); the side, the reflected and the refracted direction, and
  `lighting_normal=facing` keep to the ray.
- `offset=normal`: rays start at P ± ε·n, n of length 1, on the side to which they leave (n·w = 0
  counts as the normal's side); a shadow ray then aims from there at the light, whose distance is
  counted from there. Secondary directions do not change.
- `offset=mitsuba`: the published rule, whose constants stand in `oracle_surfaces.py`; the primary
  ray's near plane belongs to it, `epsilon` and `epsilon_twice` do not act.
- `epsilon_twice`: rays start at P + 2ε.
- `epsilon_for=shadow`: secondary rays start at P itself.
- `depth=minus-one` never goes below 0.
- `exhausted=background`: the rays that would have been sent each return B, total reflection's too.
- `nesting=tracked`: every n is the absolute index of its object's inside, the world's is 1. A ray
  carries the list of objects that it entered and has not left, and is in the last one; at the eye,
  the list is of the transparent objects that contain it, half-spaces first, then spheres from large
  to small. Crossing goes from the index of the last in the list before to that of the last after.
- `nesting=interiors`: the same list, but a ray leaves an object if the list holds it, whatever the
  side. Where the index stays the same within 1e-10, the ray goes straight on at the same depth; it
  is sent only where a bounce would be.
- `index=float32`: each n is rounded to float32, and one that becomes 1 is the next float above it.
- `tir=…` with Δ < 0: kt acts as 0, and kr as itself (`ignore`), kr + kt (`add`), kr + 1
  (`plus-one`), 1 where kr > 0 and else 0 (`needs-kr`); `always`:
  the default rule, where kt = 0 too.
- `inner_reflection=off`: where kt > 0 the inner side sends no reflected ray but the total one.
- `recursion=clamp` and `scale` act on what every ray returns, the primary ray too.
- `mix=convex`: with the kr and kt that act, thus after total reflection, at the last depth too.
- `shadow_min` and `far` (world units, 0: none): blockers at or below the one, and any hit beyond
  the other, do not exist. `light_min`: nor do blockers that are nearer than this to the light.
- `offset=bound` is an implementation's own and is not offered.
"""

from __future__ import annotations

from dataclasses import dataclass, fields

CHOICES: dict[str, tuple[str, ...]] = {
    "mix": ("additive", "convex"),
    "plane_normal": ("normalised", "raw"),
    "lighting_normal": ("given", "facing"),
    "view": ("ray", "eye"),
    "specular_gate": ("none", "lit"),
    "glass_shadow": ("opaque", "clear"),
    "shadow_distance": ("light", "ignored"),
    "offset": ("direction", "normal", "mitsuba"),
    "epsilon_twice": ("no", "yes"),
    "epsilon_for": ("all", "shadow"),
    "depth": ("as-given", "minus-one", "plus-one"),
    "exhausted": ("nothing", "background"),
    "miss": ("background", "black"),
    "refraction": ("as-given", "inverted", "one-way"),
    "nesting": ("relative", "tracked", "interiors"),
    "tir": ("full", "ignore", "add", "plus-one", "needs-kr", "always"),
    "inner_reflection": ("on", "off"),
    "recursion": ("none", "clamp", "scale"),
    "index": ("exact", "float32"),
    "overflow": ("scale", "clamp"),
    "quantise": ("truncate", "round"),
}


@dataclass(frozen=True)
class Readings:
    """One value per reading; the first of its choices is the specification's."""

    mix: str = "additive"
    plane_normal: str = "normalised"
    lighting_normal: str = "given"
    view: str = "ray"
    specular_gate: str = "none"
    glass_shadow: str = "opaque"
    shadow_distance: str = "light"
    offset: str = "direction"
    epsilon: float = 1e-5
    epsilon_twice: str = "no"
    epsilon_for: str = "all"
    depth: str = "as-given"
    exhausted: str = "nothing"
    miss: str = "background"
    refraction: str = "as-given"
    nesting: str = "relative"
    tir: str = "full"
    inner_reflection: str = "on"
    recursion: str = "none"
    index: str = "exact"
    overflow: str = "scale"
    quantise: str = "truncate"
    shadow_min: float = 0.0
    light_min: float = 0.0
    far: float = 0.0

    def __post_init__(self) -> None:
        """Take numbers as text too, and refuse a value that is not in the table."""
        for name in (item.name for item in fields(self)):
            if name not in CHOICES:
                object.__setattr__(self, name, float(getattr(self, name)))
            elif getattr(self, name) not in CHOICES[name]:
                raise ValueError(f"{name}={getattr(self, name)}: expected one of {CHOICES[name]}")
