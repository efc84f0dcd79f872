"""`crosstrace_phong`: the course's material as a Mitsuba BSDF.

| parameter | type | meaning |
|---|---|---|
| `color` | point | diffuse colour c_d, each component in 0…255 |
| `ka`, `kd`, `ks`, `eta` | float | ambient, diffuse and specular coefficient, exponent (3.2) |
| `kr`, `kt`, `n` | float | reflection, transmission, relative index of refraction (4.1, 4.2) |
| `total_reflection` | boolean | whether Δ < 0 makes kt 0 and kr 1 (default true) |
| `surface`, `place`, `normal`, `radius` | | its surface, for `crosstrace_whitted_f64` only |

Components: 0 the diffuse and 1 the specular term, evaluated for a direction to a light; 2 the
mirrored and 3 the refracted ray, which `sample` returns with kr and kt as weights. The frame is
that of the surface's literal normal, so both sides are shaded as the specification says: nothing is
flipped or gated. The attribute `ambient` is ka·c_d.
"""

# mypy: disallow-subclassing-any=False
# (Mitsuba makes its classes per variant at run time: a type checker cannot know them.)

from __future__ import annotations

from typing import Any

import drjit as dr
import mitsuba as mi
import numpy as np

from crosstrace.translators.mitsuba import shading

REFLECTED, REFRACTED = 2, 3


class Phong(mi.BSDF):
    """The material; see the table above."""

    def __init__(self, props: Any) -> None:
        """Read the parameters, in float64."""
        super().__init__(props)
        self.color = np.array(props["color"], np.float64)
        names = ("ka", "kd", "ks", "eta", "kr", "kt", "n")
        self.coefficients = tuple(float(props[name]) for name in names)
        self.total_reflection = bool(props.get("total_reflection", True))
        self.surface = str(props.get("surface", ""))
        self.geometry = np.zeros(6)
        if self.surface:
            self.geometry[:3] = props["place"]
            self.geometry[3:] = props["normal"] if self.surface == "plane" else 0.0
            if self.surface == "sphere":
                self.geometry[3] = props["radius"]
        else:
            # Opaque numbers, so that materials share one piece of code and scenes one kernel.
            ka, kd, ks, eta, kr, kt, n = self.coefficients
            self._ambient = dr.opaque(mi.Color3f, (ka * self.color / 255).tolist())
            self._diffuse = dr.opaque(mi.Color3f, (kd * self.color / 255).tolist())
            self._ks, self._eta = dr.opaque(mi.Float, ks), dr.opaque(mi.Float, eta)
            self._kr, self._kt = dr.opaque(mi.Float, kr), dr.opaque(mi.Float, kt)
            self._n = dr.opaque(mi.Float, n)
        sides = mi.BSDFFlags.FrontSide | mi.BSDFFlags.BackSide
        flags = mi.BSDFFlags
        lobes = (flags.DiffuseReflection, flags.GlossyReflection, flags.DeltaReflection,
                 flags.DeltaTransmission)  # fmt: skip
        self.m_components = [lobe | sides for lobe in lobes]
        self.m_flags = int(np.bitwise_or.reduce([int(c) for c in self.m_components]))

    def eval(self, ctx: Any, si: Any, wo: Any, active: Any = True) -> Any:
        """Return the diffuse and specular terms of 3.2 for white light from `wo`, ungated."""
        value = mi.Color3f(0)
        if ctx.is_enabled(mi.BSDFFlags.DiffuseReflection, 0):
            value = value + self._diffuse * shading.positive(wo.z)
        if ctx.is_enabled(mi.BSDFFlags.GlossyReflection, 1):
            mirrored = mi.Vector3f(-wo.x, -wo.y, wo.z)
            value = value + self._ks * shading.power_of_cosine(mirrored, si.wi, self._eta)
        return dr.select(active, value, 0)

    def sample(
        self, ctx: Any, si: Any, sample1: Any, sample2: Any, active: Any = True
    ) -> tuple[Any, Any]:
        """Return the ray of component 2 or 3 of the context, weighted by kr or kt (4.1, 4.2)."""
        m, delta, along = shading.bend(si.wi.z, self._n)
        bs = dr.zeros(mi.BSDFSample3f)
        bs.pdf, bs.eta, bs.sampled_component = 1, 1, ctx.component
        if ctx.component == REFLECTED:
            bs.wo = mi.Vector3f(-si.wi.x, -si.wi.y, si.wi.z)
            bs.sampled_type = +mi.BSDFFlags.DeltaReflection
            mirrors = ctx.is_enabled(mi.BSDFFlags.DeltaReflection, REFLECTED)
            weight = self._kr if mirrors else mi.Float(0)
            if self.total_reflection:
                weight = dr.select((self._kt > 0) & (delta < 0), 1, weight)
        else:
            bs.wo = -m * si.wi - along * mi.Vector3f(0, 0, 1)
            bs.sampled_type = +mi.BSDFFlags.DeltaTransmission
            bs.eta = 1 / m
            weight = dr.select(delta < 0, 0, self._kt)
        return bs, mi.Color3f(dr.select(active, weight, 0))

    def pdf(self, ctx: Any, si: Any, wo: Any, active: Any = True) -> Any:
        """Return 0: no direction is ever drawn at random."""
        return mi.Float(0)

    def eval_pdf(self, ctx: Any, si: Any, wo: Any, active: Any = True) -> tuple[Any, Any]:
        """Return `eval` and `pdf`."""
        return self.eval(ctx, si, wo, active), self.pdf(ctx, si, wo, active)

    def has_attribute(self, name: str, active: Any = True) -> Any:
        """Say whether `name` is `ambient`."""
        return name == "ambient"

    def eval_attribute_3(self, name: str, si: Any, active: Any = True) -> Any:
        """Return ka·c_d for `ambient`."""
        return dr.select(active, self._ambient, 0)

    def to_string(self) -> str:
        """Describe the material on one line."""
        return f"Phong[color={self.color.tolist()}, ka kd ks eta kr kt n={self.coefficients}]"
