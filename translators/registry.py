"""Which renderers there are: a new one is one folder and one line here."""

from __future__ import annotations

from importlib import import_module

from crosstrace.translators.errors import UsageError
from crosstrace.translators.renderer import Renderer

#: Lane → where its factory stands. Nothing is imported before a lane is asked for.
_LANES = {
    "native": "crosstrace.translators.native.adapter:Native",
    "mitsuba": "crosstrace.translators.mitsuba.adapter:MitsubaStock",
    "mitsuba-f64": "crosstrace.translators.mitsuba.adapter:MitsubaExact",
    "povray": "crosstrace.translators.povray.adapter:PovRay",
}

LANES = tuple(_LANES)


def renderer(lane: str) -> Renderer:
    """Return the renderer of a lane; raises UsageError for an unknown name."""
    if lane not in _LANES:
        raise UsageError(f"expected a renderer out of {', '.join(LANES)}, found {lane!r}")
    module, _, factory = _LANES[lane].partition(":")
    made: Renderer = getattr(import_module(module), factory)()
    return made
