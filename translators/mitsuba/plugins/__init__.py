"""The Mitsuba plugins of this project; importing this module registers them.

| kind | name | what it is |
|---|---|---|
| bsdf | `crosstrace_phong` | the course's Phong material, mirror and glass |
| emitter | `crosstrace_point` | a point light without falloff |
| sensor | `crosstrace_pinhole` | the course's camera, from float64 numbers |
| integrator | `crosstrace_whitted` | Whitted's recursion, Mitsuba's own ray queries, float32 |
| integrator | `crosstrace_whitted_f64` | the same recursion, every computation in Float64 |

A variant must be set before the import, or `llvm_ad_rgb` is.
"""

from __future__ import annotations

import mitsuba as mi

if mi.variant() is None:
    mi.set_variant("llvm_ad_rgb")

from crosstrace.translators.mitsuba.plugins.phong import Phong
from crosstrace.translators.mitsuba.plugins.pinhole import Pinhole
from crosstrace.translators.mitsuba.plugins.point import Point
from crosstrace.translators.mitsuba.plugins.whitted import Whitted
from crosstrace.translators.mitsuba.plugins.whitted_f64 import WhittedF64

mi.register_bsdf("crosstrace_phong", Phong)
mi.register_emitter("crosstrace_point", Point)
mi.register_sensor("crosstrace_pinhole", Pinhole)
mi.register_integrator("crosstrace_whitted", Whitted)
mi.register_integrator("crosstrace_whitted_f64", WhittedF64)

__all__ = ["Phong", "Pinhole", "Point", "Whitted", "WhittedF64"]
