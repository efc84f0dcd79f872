"""`crosstrace_whitted`: the specification's recursion on Mitsuba's own ray queries, in float32.

| parameter | type | meaning |
|---|---|---|
| `ambient`, `background` | point | c_a and B, each component in 0…255 |
| `max_depth` | integer | bounces (4) |
| `effects` | string | names of the effects to trace, between blanks (default: all) |
| `branches` | boolean | whether one hit can both reflect and refract (default true) |

Intersections, surface points, ray offsets and shadow limits are Mitsuba's (`ray_intersect`,
`SurfaceInteraction3f.p`, `spawn_ray`, `spawn_ray_to`). Shadow rays ask for the nearest hit rather
than for any: the any-hit test of `sphere` does not re-centre the ray and loses digits far away.
"""

# mypy: disallow-subclassing-any=False
# (Mitsuba makes its classes per variant at run time: a type checker cannot know them.)

from __future__ import annotations

from typing import Any

import drjit as dr
import mitsuba as mi

from crosstrace.translators.effects import EFFECTS
from crosstrace.translators.mitsuba.plugins.phong import REFLECTED, REFRACTED
from crosstrace.translators.mitsuba.recursion import Kinds, Ray, Step, radiance

#: Mitsuba holds max_depth as a signed 32-bit number; no ray ever gets there.
DEPTH_LIMIT = 2**31 - 1


class Whitted(mi.SamplingIntegrator):
    """The integrator; see the table above."""

    def __init__(self, props: Any) -> None:
        """Read the parameters."""
        super().__init__(props)
        self._ambient = dr.opaque(mi.Color3f, [c / 255 for c in props["ambient"]])
        self._background = dr.opaque(mi.Color3f, [c / 255 for c in props["background"]])
        self._max_depth = int(props.get("max_depth", 0))
        self._depth = dr.opaque(mi.UInt32, self._max_depth)
        self._effects = frozenset(props.get("effects", " ".join(EFFECTS)).split())
        self._branches = bool(props.get("branches", True))
        flags = mi.BSDFFlags
        lobes = {
            "diffuse": flags.DiffuseReflection, "specular": flags.GlossyReflection,
            "reflection": flags.DeltaReflection, "refraction": flags.DeltaTransmission,
        }  # fmt: skip
        self._lobes = sum(int(lobe) for name, lobe in lobes.items() if name in self._effects)

    def sample(
        self, scene: Any, sampler: Any, ray: Any, medium: Any = None, active: Any = True
    ) -> tuple[Any, Any, list[Any]]:
        """Return the colour of each ray, unclamped."""
        kinds = Kinds(mi.Float, mi.Vector3f, mi.Color3f, mi.UInt32)

        def trace(o: Any, d: Any, primary: Any, on: Any) -> Step:
            return self._trace(scene, o, d, on)

        spawning = {"reflection", "refraction", "total_reflection"} & self._effects
        color = radiance(
            kinds, trace, (mi.Vector3f(ray.o), ray.d), mi.Bool(active), max_depth=self._depth,
            bounces=bool(spawning) and self._max_depth > 0, branches=self._branches,
        )  # fmt: skip
        return color, mi.Bool(True), []

    def _trace(self, scene: Any, origin: Any, direction: Any, active: Any) -> Step:
        ray = mi.Ray3f(mi.Point3f(origin), direction)
        si = scene.ray_intersect(ray, active)
        on = active & si.is_valid()
        bsdf = si.bsdf()
        color = dr.select(on, self._local(scene, si, bsdf, on), self._background)
        total = "total_reflection" in self._effects
        mirrors = total or "reflection" in self._effects
        mirror = self._child(si, bsdf, REFLECTED, on) if mirrors else None
        glass = self._child(si, bsdf, REFRACTED, on) if "refraction" in self._effects else None
        return Step(color, mirror, glass)

    def _local(self, scene: Any, si: Any, bsdf: Any, on: Any) -> Any:
        color = dr.zeros(mi.Color3f, dr.width(si.t))
        if {"flat", "ambient"} & self._effects:
            # The first delivery has ka = 1 and white ambient light, so its colour is this term.
            color = color + self._ambient * bsdf.eval_attribute_3("ambient", si, on)
        lights = scene.emitters_dr()
        if not ({"diffuse", "specular"} & self._effects) or not len(lights):
            return color
        ctx = mi.BSDFContext(mi.TransportMode.Radiance, self._lobes)
        count = dr.opaque(mi.UInt32, len(lights))

        def body(j: Any, color: Any) -> Any:
            emitter = dr.gather(mi.EmitterPtr, lights, j, on)
            ds, light = emitter.sample_direction(si, mi.Point2f(0), on)
            share = light * bsdf.eval(ctx, si, si.to_local(ds.d), on)
            lit = on & dr.any(share > 0)
            if "shadows" in self._effects:
                shadow = scene.ray_intersect_preliminary(si.spawn_ray_to(ds.p), False, active=lit)
                lit &= ~shadow.is_valid()
            return j + 1, color + dr.select(lit, share, 0)

        state = (dr.zeros(mi.UInt32, dr.width(si.t)), color)
        return dr.while_loop(state, lambda j, _: on & (j < count), body, label="lights")[1]

    def _child(self, si: Any, bsdf: Any, component: int, on: Any) -> Ray:
        ctx = mi.BSDFContext(mi.TransportMode.Radiance, self._lobes, component)
        sample, weight = bsdf.sample(ctx, si, 0, mi.Point2f(0), on)
        ray = si.spawn_ray(si.to_world(sample.wo))
        return Ray(mi.Vector3f(ray.o), ray.d, dr.select(on, weight.x, 0))

    def aov_names(self) -> list[str]:
        """Return no names: colour is the only output."""
        return []

    def to_string(self) -> str:
        """Describe the integrator on one line."""
        return f"Whitted[max_depth={self._max_depth}, effects={sorted(self._effects)}]"
