"""The renderers as the harness names them: lanes, in one order everywhere."""

from __future__ import annotations

from collections.abc import Iterable
from functools import lru_cache

from crosstrace.translators.errors import UsageError
from crosstrace.translators.registry import LANES, renderer
from crosstrace.translators.renderer import Renderer

__all__ = ["LANES", "chosen", "loaded"]


@lru_cache(maxsize=None)
def loaded(lane: str) -> Renderer:
    """Return a lane's renderer, one for the process: what it loads stays warm."""
    return renderer(lane)


def chosen(names: str | Iterable[str] | None) -> tuple[str, ...]:
    """Return lanes by name (a comma-separated text or names), None: all of them.

    They come in the registry's order, the reference first, and renderers from outside after them.
    Raises UsageError for a name that is neither.
    """
    if names is None:
        return LANES
    listed = names.split(",") if isinstance(names, str) else list(names)
    wanted = dict.fromkeys(name.strip() for name in listed if name.strip())
    for name in wanted:
        if name not in LANES and ":" not in name:
            expected = ", ".join(LANES)
            raise UsageError(f"expected renderers out of {expected}, found {name!r}")
    if not wanted:
        raise UsageError("expected at least one renderer, found none")
    inside = tuple(lane for lane in LANES if lane in wanted)
    return inside + tuple(name for name in wanted if name not in LANES)
