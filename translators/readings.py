"""Readings: other interpretations of the specification, by name, as the native tracer knows them.

The table of names, values and defaults stands once, in the native part (`native/src/options.c`).
What a name leaves open is settled here:

- ``view=eye`` changes r·ωo alone; side, reflection and refraction keep to the ray.
- ``lighting_normal=facing`` flips n in n·l and r alone.
- ``offset=normal`` starts at P ± ε·n, on the side to which the ray leaves; a shadow ray aims at the
  light from there. ``offset=bound`` takes a bound of the rounding of P for ε there, and
  ``offset=mitsuba`` Mitsuba's rule, near plane included.
- ``epsilon_twice=yes`` is 2ε. ``epsilon_for=shadow`` lets secondary rays start at P itself.
- ``depth=minus-one`` never goes below 0.
- ``exhausted=background``: each ray that is not sent for want of depth returns B.
- ``refraction=one-way`` takes n on both sides, ``inverted`` 1/n outside and n inside.
- ``nesting=tracked``: every n is absolute, the world's is 1, and a ray is in the object that it
  entered last and has not left; the eye is in the transparent objects that contain it.
  ``nesting=interiors`` is POV-Ray's list of interiors: the same, but whether a ray enters or leaves
  is what the list says, and where the index does not change (leaving an object that is not the
  innermost) the ray goes straight on and the crossing is no bounce; it still has to be within
  max_depth.
- ``tir=…`` where Δ < 0, with kt as 0: kr stays (``ignore``), becomes kr + kt (``add``), kr + 1
  (``plus-one``), 1 where kr > 0 (``needs-kr``); ``always`` applies the default where kt = 0 too.
- ``inner_reflection=off``: glass reflects inside only totally.
- ``recursion=…`` acts on what every ray returns, the primary ray too.
- ``mix=convex`` takes the kr and kt that act, thus after total reflection.
- ``shadow_min`` and ``far`` are limits of other renderers: a blocker at or nearer than the one, and
  any hit beyond the other, do not exist (world units; 0: no limit).
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from crosstrace.native import _core
from crosstrace.translators.errors import UnsupportedSceneError, UsageError


def split(settings: Iterable[str]) -> dict[str, str]:
    """Split `name=value` texts, without looking whether such readings exist."""
    readings = {}
    for setting in settings:
        name, equals, value = setting.partition("=")
        # The one reading that is a plain yes needs no value.
        if not equals and name.strip() == "epsilon_twice":
            value = "yes"
        readings[name.strip()] = value.strip()
    return readings


def parse(settings: Iterable[str]) -> dict[str, str]:
    """Read `name=value` texts; raises UsageError for an unknown name or value."""
    readings = split(settings)
    check(readings)
    return readings


def check(readings: Mapping[str, str]) -> None:
    """Raise UsageError where a name or a value is not one that the native tracer knows."""
    for name, value in readings.items():
        if fault := _core.check_reading(name, value):
            expected, found = fault
            raise UsageError(f"reading {name}={value}: expected {expected}, found {found}")


def deviating(readings: Mapping[str, str]) -> dict[str, str]:
    """Return the readings that differ from the defaults."""
    defaults = {name: default for name, default, _ in _core.readings()}
    return {name: value for name, value in readings.items() if value != defaults.get(name)}


def only_default(readings: Mapping[str, str], lane: str, tolerance: float = 0.0) -> None:
    """Raise UnsupportedSceneError where a lane without readings or pruning is asked for one."""
    if tolerance:
        raise UnsupportedSceneError(f"{lane} traces every ray, found a tolerance of {tolerance:g}")
    if other := deviating(readings):
        listed = ", ".join(f"{name}={value}" for name, value in other.items())
        raise UnsupportedSceneError(f"{lane} renders the default readings only, found {listed}")
