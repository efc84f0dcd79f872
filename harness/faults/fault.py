"""What a fault is: a name, a sentence, and for each lane a way of planting it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Literal, Protocol

from crosstrace.translators.errors import UsageError
from crosstrace.translators.renderer import Renderer, Rendering, RenderOptions
from crosstrace.translators.scene import Scene

Kind = Literal["reading", "scene edit", "effect left out", "image operation", "text edit"]

#: Has a renderer render, and checks what comes back.
Draw = Callable[[Renderer, Scene, RenderOptions], Rendering]


class Way(Protocol):
    """One way of planting a fault in a lane."""

    @property
    def kind(self) -> Kind:
        """What is tampered with."""

    def render(
        self, lane: str, scene: Scene, options: RenderOptions, draw: Draw
    ) -> Rendering | None:
        """Render with the fault in place; None where the scene has nothing to break."""


@dataclass(frozen=True)
class Fault:
    """A fault and how each lane that can have it gets it.

    `where` says for which scenes the fault means anything: a scene without a highlight has no
    exponent to be wrong about.
    """

    name: str
    sentence: str
    where: Callable[[Scene], bool]
    ways: Mapping[str, Way]

    @property
    def lanes(self) -> tuple[str, ...]:
        """The lanes in which it can be planted."""
        return tuple(self.ways)

    def kind(self, lane: str) -> Kind:
        """Say what is tampered with in a lane; raises UsageError for one that cannot have it."""
        return self._way(lane).kind

    def render(
        self, lane: str, scene: Scene, options: RenderOptions, draw: Draw
    ) -> Rendering | None:
        """Render a scene by a lane with the fault in place, in this process.

        None where the scene has nothing to break, so that the image would be the honest one.
        Raises UsageError for a lane that cannot have the fault, otherwise what `draw` raises.
        """
        way = self._way(lane)
        return way.render(lane, scene, options, draw) if self.where(scene) else None

    def _way(self, lane: str) -> Way:
        if lane not in self.ways:
            expected = ", ".join(self.ways)
            raise UsageError(f"fault {self.name}: expected a lane out of {expected}, found {lane}")
        return self.ways[lane]
