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
    """Return the renderer of a lane; raises UsageError for an unknown name.

    A name ``module:factory`` is a renderer that stands outside this package.
    """
    module, colon, factory = _LANES.get(lane, lane).partition(":")
    try:
        if not colon:
            raise ImportError
        made: Renderer = getattr(import_module(module), factory)()
    except (ImportError, AttributeError) as error:
        if lane in _LANES:
            raise
        names = f"{', '.join(LANES)} or module:factory"
        raise UsageError(f"expected a renderer out of {names}, found {lane!r}") from error
    return made
