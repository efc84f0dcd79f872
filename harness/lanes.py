"""The renderers as the harness names them: lanes, in one order everywhere."""

from __future__ import annotations

from collections.abc import Iterable
from functools import cache
from importlib import import_module

from crosstrace.translators.errors import UsageError
from crosstrace.translators.registry import LANES, renderer
from crosstrace.translators.renderer import Renderer

__all__ = ["LANES", "REFERENCE", "chosen", "loaded"]

#: The lane that takes readings of the specification and other precisions.
REFERENCE = "native"


@cache
def loaded(lane: str) -> Renderer:
    """Return a lane's renderer, one for the process: what it loads stays warm.

    From Python, ``module:factory`` names a renderer that stands outside this package. Raises
    UsageError for any other unknown name.
    """
    module, colon, factory = lane.partition(":")
    if not colon:
        return renderer(lane)
    made: Renderer = getattr(import_module(module), factory)()
    return made


def chosen(names: str | Iterable[str] | None) -> tuple[str, ...]:
    """Return lanes by name (a comma-separated text or names), None: all of them.

    They come in the registry's order, the reference first. Raises UsageError for an unknown name.
    """
    if names is None:
        return LANES
    listed = names.split(",") if isinstance(names, str) else list(names)
    wanted = dict.fromkeys(name.strip() for name in listed if name.strip())
    for name in wanted:
        if name not in LANES:
            expected = ", ".join(LANES)
            raise UsageError(f"expected renderers out of {expected}, found {name!r}")
    if not wanted:
        raise UsageError("expected at least one renderer, found none")
    return tuple(lane for lane in LANES if lane in wanted)
