"""crosstrace: one scene through independent ray tracers, every differing pixel explained.

    import crosstrace as ct
    scene = ct.load("scene.txt")
    image = ct.render(scene, "mitsuba")            # (v_res, h_res, 3) float64, linear
    ct.compare(image, ct.render(scene, "native"))  # numbers on linear float, SSIM

Nothing heavy is imported before it is needed.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from crosstrace.harness.api import (
        LANES,
        Comparison,
        compare,
        effects,
        load,
        render,
        render_full,
        run,
    )
    from crosstrace.translators.errors import (
        CrosstraceError,
        RendererError,
        RendererMissingError,
        SceneError,
        UnsupportedSceneError,
        UsageError,
    )
    from crosstrace.translators.scene import Scene, plane, sphere

_HOMES = {
    "crosstrace.harness.api": (
        "LANES", "Comparison", "compare", "effects", "load", "render", "render_full", "run",
    ),
    "crosstrace.translators.errors": (
        "CrosstraceError", "RendererError", "RendererMissingError", "SceneError",
        "UnsupportedSceneError", "UsageError",
    ),
    "crosstrace.translators.scene": ("Scene", "plane", "sphere"),
}  # fmt: skip
_HOME_OF = {name: home for home, names in _HOMES.items() for name in names}

__all__ = [
    "LANES", "Comparison", "CrosstraceError", "RendererError", "RendererMissingError", "Scene",
    "SceneError", "UnsupportedSceneError", "UsageError", "compare", "effects", "load", "plane",
    "render", "render_full", "run", "sphere",
]  # fmt: skip


def __getattr__(name: str) -> Any:
    """Import a public name from where it lives, at its first use."""
    if name == "__version__":
        from importlib.metadata import version

        return version("crosstrace")
    if name not in _HOME_OF:
        raise AttributeError(f"module 'crosstrace' has no attribute {name!r}")
    return getattr(import_module(_HOME_OF[name]), name)


def __dir__() -> list[str]:
    """List the public names without importing them."""
    return [*__all__, "__version__"]
