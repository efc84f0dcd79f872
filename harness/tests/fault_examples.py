"""Small scenes for the tests of faults: where each fault shows, and lanes that work here."""

from __future__ import annotations

from functools import cache

import pytest

from crosstrace.harness import alone, sources, tasks
from crosstrace.translators.errors import RendererError
from crosstrace.translators.renderer import Rendering, RenderOptions
from crosstrace.translators.scene import Scene

SIZE = (60, 80)
OPTIONS = RenderOptions(threads=1, timeout_s=120.0)

#: A packaged scene in which a fault shows, where the glass of `bolha4` does not show it.
EXAMPLES = {
    "clamp-instead-of-scale": "piramide",
    "index-as-given": "nested-glass",
    "adc-bailout-default": "espelho3",
    "light-moved-1e-2": "venn",
}


@cache
def small(name: str, rows: int = SIZE[0], columns: int = SIZE[1]) -> Scene:
    """Return a packaged scene at a small size."""
    return sources.find_one(name, size=(rows, columns)).scene


def example(fault: str) -> Scene:
    """Return a scene in which a fault shows."""
    return small(EXAMPLES.get(fault, "bolha4"))


@cache
def honest(lane: str, name: str) -> Rendering:
    """Render a packaged scene at the small size, as it is."""
    return tasks.render(lane, small(name), OPTIONS)[0]


@cache
def _reason(lane: str) -> str:
    try:
        return alone.probe(lane).reason
    except RendererError as error:
        return str(error)


def need(lane: str) -> None:
    """Skip the test where a lane does not work here."""
    if reason := _reason(lane):
        pytest.skip(f"{lane} does not work here: {reason}")
