"""A plan as a POV-Ray scene description that plain `povray` renders.

Nothing but numbers of ours goes into the text, each as `repr` writes it, so a scene file cannot
smuggle in a directive (POV-Ray reads and writes files on request). How each surface is written:

| surface | written as |
|---|---|
| opaque | the object; its own shadow |
| transparent (kt > 0) | a visible twin that casts no shadow and a black twin that only shadow rays meet, because here any object blocks a light wholly |
| holds the camera, by POV-Ray's own test | `inverse`, so that no ray starts inside an interior |
| lit from both sides | in a light group, see `lights.py` |

POV-Ray multiplies the ambient and diffuse terms by 1 − filter − transmit and a refracted ray by
pigment·filter + transmit. With filter −t, transmit +t and a pigment scaled by 2⁻³⁰ (undone in the
finish) these factors are exactly 1 and exactly t = kt, also for kt = 1.
"""  # noqa: E501 - a table is read by its rows

from __future__ import annotations

from collections.abc import Iterable
from fractions import Fraction

import numpy as np

from crosstrace.translators.povray.camera import CameraSide, basis
from crosstrace.translators.povray.lights import Lighting
from crosstrace.translators.povray.media import Media
from crosstrace.translators.povray.plan import NEGLIGIBLE, Array, Plan
from crosstrace.translators.povray.scale import diffuse_share
from crosstrace.translators.scene import ETA, KA, KR, KS, KT

_TINY = 2.0**-30


class Writer:
    """Writes one plan; the parts are those that the plan was analysed into."""

    def __init__(
        self, plan: Plan, side: CameraSide, media: Media, lighting: Lighting, scale: float
    ) -> None:
        """Keep the parts; `scale` is the world scale."""
        self.plan, self.side, self.media, self.lighting = plan, side, media, lighting
        self.scale = scale
        self.diffuse = diffuse_share(plan, lighting)
        self.hides = plan.material[:, KT] > 0
        self.shapes = [self._shape(i) for i in range(len(plan))]

    def text(self, output_scale: float) -> str:
        """Return the description; `output_scale` holds unless the command line declares another."""
        lines = [
            "#version 3.7;",
            f"#ifndef (output_scale) #declare output_scale = {_number(output_scale)}; #end",
            f"global_settings {{ assumed_gamma 1 max_trace_level {self.plan.depth + 1}",
            f"  adc_bailout {_number(NEGLIGIBLE) if self.plan.deep else 0}",
            f"  ambient_light {_rgb(self.plan.ambient)}/output_scale }}",
            f"background {{ {_rgb(self.plan.scene.background / 255)}/output_scale }}",
            self._camera(),
        ]
        if self.lighting.fill.any() and self.plan.shadows:
            lines += ["#declare blockers = union {", *(f"  {s} }}" for s in self.shapes), "}"]
        lines += [f"light_source {{ {self._light(j)} }}" for j in range(len(self.plan.lights))]
        for i in range(len(self.plan)):
            lines += self._grouped(i) if self.lighting.group[i] else [self._visible(i)]
            if self.hides[i] and self.plan.shadows:
                lines.append(self._shadow(i))
        return "\n".join(lines) + "\n"

    def _camera(self) -> str:
        scene, (u, v, w) = self.plan.scene, basis(self.plan.scene)
        width, height = scene.pixel_size * scene.h_res, scene.pixel_size * scene.v_res
        return (
            f"camera {{ perspective location {_vector(self.scale * scene.eye)}\n"
            f"  direction {_vector(-scene.screen_distance * w)}\n"
            f"  right {_vector(width * u)} up {_vector(height * v)} }}"
        )

    def _shape(self, i: int) -> str:
        geometry = self.plan.geometry[i]
        if self.plan.sphere[i]:
            center, radius = self.scale * geometry[:3], self.scale * geometry[3]
            return f"sphere {{ {_vector(center)}, {_number(radius)}"
        point, normal = geometry[:3], geometry[3:]
        # The normal is rounded: turn the plane about its own point, not about the origin.
        exact = sum(
            Fraction(float(p)) * Fraction(float(n)) for p, n in zip(point, normal, strict=True)
        )
        distance = self.scale * float(exact) + float(self.side.shift[i])
        return f"plane {{ {_vector(normal)}, {_number(distance)}"

    def _visible(self, i: int) -> str:
        ka, ks, eta, kr, kt = (float(self.plan.material[i, c]) for c in (KA, KS, ETA, KR, KT))
        kd, color = float(self.diffuse[i]), self.plan.color[i]
        if self.hides[i]:
            t = float(np.float32(kt))
            filtered = (*(_TINY * color), -t, t)
            pigment, ka, kd = f"rgbft {_vector(filtered)}", ka / _TINY, kd / _TINY
        else:
            pigment = _rgb(color)
        finish = f"ambient {_number(ka)} diffuse {_number(kd)}"
        if ks:
            finish += f" phong {_number(ks)} phong_size {_number(eta)}"
        if kr:
            finish += f" reflection {{ {_number(kr)} }}"
        after = [f"texture {{ pigment {{ {pigment} }} finish {{ {finish} }} }}"]
        if self.hides[i]:
            after.append(f"interior {{ ior {_number(float(self.media.ior[i]))} }}")
        if self.side.listed[i]:
            after.append("inverse")
        if self.lighting.double[i]:
            after.append("double_illuminate")
        if self.hides[i] or not self.plan.shadows:
            after.append("no_shadow")
        return f"{self.shapes[i]} {' '.join(after)} }}"

    def _shadow(self, i: int) -> str:
        inverse = " inverse" if self.side.listed[i] else ""
        return f"{self.shapes[i]} pigment {{ rgb 0 }}{inverse} no_image no_reflection }}"

    def _light(self, j: int, sign: float = 1.0) -> str:
        light = self.plan.lights[j]
        return f"{_vector(self.scale * light[3:])} {_rgb(sign * light[:3])}/output_scale"

    def _grouped(self, i: int) -> Iterable[str]:
        inner = self.lighting.inner[i]
        yield "light_group {"
        for j in range(len(inner)):
            if not inner[j] or self.lighting.fill[i]:
                yield f"  light_source {{ {self._light(j)} }}"
        for j in map(int, np.flatnonzero(inner & self.lighting.fill[i])):
            yield f"  light_source {{ {self._light(j, -1.0)} shadowless }}"
            if self.plan.shadows:
                through = "projected_through { blockers }"
                yield f"  light_source {{ {self._light(j)} shadowless {through} }}"
        yield f"  {self._visible(i)}"
        yield "  global_lights off }"


def _number(value: float) -> str:
    return repr(float(value))


def _vector(values: Iterable[float] | Array) -> str:
    return f"<{', '.join(map(_number, values))}>"


def _rgb(values: Iterable[float] | Array) -> str:
    return f"rgb {_vector(values)}"
