"""crosstrace: one scene through independent ray tracers, every differing pixel explained.

    import crosstrace as ct
    scene = ct.load("x.txt")
    image = ct.render(scene, "mitsuba")
    ct.compare(ct.render(scene, "native"), image, scene=scene).ssim

Nothing heavy is imported before it is used.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from crosstrace.harness.api import load, probe, render, render_full, translate
    from crosstrace.harness.comparison import Comparison, compare
    from crosstrace.harness.explain import Explanation, explain
    from crosstrace.harness.session import RunOptions, run
    from crosstrace.translators.course import dumps
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

_HOMES = {
    "crosstrace.harness.api": ("load", "probe", "render", "render_full", "translate"),
    "crosstrace.harness.comparison": ("Comparison", "compare"),
    "crosstrace.harness.explain": ("Explanation", "explain"),
    "crosstrace.harness.session": ("RunOptions", "run"),
    "crosstrace.translators.course": ("dumps",),
    "crosstrace.translators.effects": ("effects",),
    "crosstrace.translators.errors": (
        "CrosstraceError", "RendererError", "RendererMissingError",
        "SceneError", "UnsupportedSceneError", "UsageError",
    ),
    "crosstrace.translators.registry": ("LANES",),
    "crosstrace.translators.renderer": ("Rendering",),
    "crosstrace.translators.scene": ("Scene", "plane", "sphere"),
}  # fmt: skip

_HOME_OF = {name: home for home, names in _HOMES.items() for name in names}

__all__ = [
    "LANES", "Comparison", "CrosstraceError", "Explanation", "RendererError",
    "RendererMissingError", "Rendering", "RunOptions", "Scene", "SceneError",
    "UnsupportedSceneError", "UsageError", "__version__", "compare", "dumps", "effects", "explain",
    "load", "plane", "probe", "render", "render_full", "run", "sphere", "translate",
]  # fmt: skip


def __getattr__(name: str) -> Any:
    """Import a public name from its home when it is first asked for."""
    if name == "__version__":
        value: Any = _version()
    elif name in _HOME_OF:
        value = getattr(import_module(_HOME_OF[name]), name)
    else:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    """List the public names, imported or not."""
    return sorted({*globals(), *__all__})


def _version() -> str:
    from importlib.metadata import PackageNotFoundError, version

    try:
        return version("crosstrace")
    except PackageNotFoundError:
        # A source tree that is used without being installed.
        from crosstrace.native._core import version as built

        return built
