"""crosstrace: one scene through independent ray tracers, every differing pixel explained.

    import crosstrace as ct

    scene = ct.load("x.txt")
    image = ct.render(scene, "mitsuba")
    print(ct.compare(ct.render(scene, "native"), image, scene=scene).metrics.max)

Images are linear RGB, (v_res, h_res, 3) float64, row 0 at the top. Renderers run in processes of
this package, so a script needs no ``__main__`` guard and survives their crashes.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from crosstrace.harness.api import (
        Comparison,
        compare,
        load,
        probe,
        render,
        render_full,
        run,
        translate,
    )
    from crosstrace.translators.effects import effects
    from crosstrace.translators.errors import (
        CrosstraceError,
        RendererError,
        RendererMissingError,
        SceneError,
        UnsupportedSceneError,
        UsageError,
    )
    from crosstrace.translators.registry import LANES
    from crosstrace.translators.renderer import Rendering
    from crosstrace.translators.scene import Scene, plane, sphere

    __version__: str

#: Where each public name stands: nothing is imported before it is used.
_PLACES = {
    "Comparison": "crosstrace.harness.api",
    "CrosstraceError": "crosstrace.translators.errors",
    "LANES": "crosstrace.translators.registry",
    "Rendering": "crosstrace.translators.renderer",
    "RendererError": "crosstrace.translators.errors",
    "RendererMissingError": "crosstrace.translators.errors",
    "Scene": "crosstrace.translators.scene",
    "SceneError": "crosstrace.translators.errors",
    "UnsupportedSceneError": "crosstrace.translators.errors",
    "UsageError": "crosstrace.translators.errors",
    "compare": "crosstrace.harness.api",
    "effects": "crosstrace.translators.effects",
    "load": "crosstrace.harness.api",
    "plane": "crosstrace.translators.scene",
    "probe": "crosstrace.harness.api",
    "render": "crosstrace.harness.api",
    "render_full": "crosstrace.harness.api",
    "run": "crosstrace.harness.api",
    "sphere": "crosstrace.translators.scene",
    "translate": "crosstrace.harness.api",
}

__all__ = [
    "LANES", "Comparison", "CrosstraceError", "Rendering", "RendererError", "RendererMissingError",
    "Scene", "SceneError", "UnsupportedSceneError", "UsageError", "__version__", "compare",
    "effects", "load", "plane", "probe", "render", "render_full", "run", "sphere", "translate",
]  # fmt: skip


def __getattr__(name: str) -> Any:
    """Import a public name when it is first used."""
    if name == "__version__":
        from importlib.metadata import PackageNotFoundError, version

        try:
            value: Any = version("crosstrace")
        except PackageNotFoundError:
            value = "0+unknown"
    elif name in _PLACES:
        value = getattr(import_module(_PLACES[name]), name)
    else:
        raise AttributeError(f"module 'crosstrace' has no attribute {name!r}")
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    """List the public names."""
    return sorted(__all__)
