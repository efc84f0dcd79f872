"""For which scenes a fault means anything: what of a scene a pixel can depend on."""

from __future__ import annotations

from collections.abc import Callable

from crosstrace.translators.effects import effects
from crosstrace.translators.scene import KT, N, Scene

Situation = Callable[[Scene], bool]

SECONDARY = frozenset({"reflection", "refraction", "total_reflection"})


def always(scene: Scene) -> bool:
    """Any scene."""
    return True


def calls_for(*names: str) -> Situation:
    """Scenes that call for any of these effects."""
    return lambda scene: not set(names).isdisjoint(effects(scene).names)


def offsets(scene: Scene) -> bool:
    """Scenes with a ray that starts on a surface."""
    return not (SECONDARY | {"shadows"}).isdisjoint(effects(scene).names)


def bounces(scene: Scene) -> bool:
    """Scenes that send a secondary ray."""
    return not SECONDARY.isdisjoint(effects(scene).names)


def would_bounce_deeper(scene: Scene) -> bool:
    """Scenes that send a secondary ray with one bounce more."""
    return not SECONDARY.isdisjoint(effects(scene, {"depth": "plus-one"}).names)


def glass_shades(scene: Scene) -> bool:
    """Scenes in which something transparent may stand before a light."""
    return bool((scene.material[:, KT] > 0).any()) and "shadows" in effects(scene).names


def bends(scene: Scene) -> bool:
    """Scenes in which a ray changes its direction on its way through a surface."""
    material = scene.material
    bent = bool(((material[:, KT] > 0) & (material[:, N] != 1.0)).any())
    return bent and "refraction" in effects(scene).names
