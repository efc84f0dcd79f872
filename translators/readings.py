"""Readings: other interpretations of the specification, by name, as the native tracer knows them.

The table of names, values and defaults stands once, in the native part (`native/src/options.c`).
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from crosstrace.native import _core
from crosstrace.translators.errors import UnsupportedSceneError, UsageError


def parse(settings: Iterable[str]) -> dict[str, str]:
    """Read `name=value` texts; raises UsageError for an unknown name or value."""
    readings = {}
    for setting in settings:
        name, equals, value = setting.partition("=")
        if not equals and name in ("epsilon_twice",):
            value = "yes"
        readings[name.strip()] = value.strip()
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


def only_default(readings: Mapping[str, str], lane: str) -> None:
    """Raise UnsupportedSceneError where a lane that has no readings is asked for one."""
    if other := deviating(readings):
        listed = ", ".join(f"{name}={value}" for name, value in other.items())
        raise UnsupportedSceneError(f"{lane} renders the default readings only, found {listed}")
