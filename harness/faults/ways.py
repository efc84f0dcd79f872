"""The ways of planting a fault: in what a lane is told, in what it writes, in what it returns."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from crosstrace.harness.faults.broken import (
    DocumentChange,
    NothingToBreakError,
    TextChange,
    broken_mitsuba,
    broken_povray,
)
from crosstrace.harness.faults.fault import Draw, Kind
from crosstrace.harness.lanes import loaded
from crosstrace.translators.effects import effects
from crosstrace.translators.renderer import Renderer, Rendering, RenderOptions
from crosstrace.translators.scene import Scene

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Reading:
    """The lane reads the specification in another way."""

    kind: ClassVar[Kind] = "reading"
    readings: Mapping[str, str]

    def render(
        self, lane: str, scene: Scene, options: RenderOptions, draw: Draw
    ) -> Rendering | None:
        """Render under the readings."""
        wrong = {**options.readings, **self.readings}
        return draw(loaded(lane), scene, replace(options, readings=wrong))


@dataclass(frozen=True)
class SceneEdit:
    """The lane is given another scene; the edit returns None where there is nothing to edit."""

    kind: ClassVar[Kind] = "scene edit"
    edit: Callable[[Scene], Scene | None]

    def render(
        self, lane: str, scene: Scene, options: RenderOptions, draw: Draw
    ) -> Rendering | None:
        """Render the other scene."""
        wrong = self.edit(scene)
        return None if wrong is None or wrong == scene else draw(loaded(lane), wrong, options)


@dataclass(frozen=True)
class Without:
    """The lane leaves an effect out that the scene calls for."""

    kind: ClassVar[Kind] = "effect left out"
    effect: str

    def render(
        self, lane: str, scene: Scene, options: RenderOptions, draw: Draw
    ) -> Rendering | None:
        """Render without the effect."""
        wanted = options.effects
        if wanted is None:
            wanted = frozenset(effects(scene, options.readings).names)
        if self.effect not in wanted:
            return None
        return draw(loaded(lane), scene, replace(options, effects=wanted - {self.effect}))


@dataclass(frozen=True)
class ImageOperation:
    """The lane renders honestly, and its linear image (v_res, h_res, 3) is tampered with."""

    kind: ClassVar[Kind] = "image operation"
    operate: Callable[[Array], Array]

    def render(
        self, lane: str, scene: Scene, options: RenderOptions, draw: Draw
    ) -> Rendering | None:
        """Render and tamper."""
        made = draw(loaded(lane), scene, options)
        wrong = self.operate(made.image)
        if np.array_equal(wrong, made.image, equal_nan=True):
            return None
        return replace(made, image=wrong)


@dataclass(frozen=True)
class SdlEdit:
    """The description that POV-Ray reads is tampered with."""

    kind: ClassVar[Kind] = "text edit"
    edit: TextChange

    def render(
        self, lane: str, scene: Scene, options: RenderOptions, draw: Draw
    ) -> Rendering | None:
        """Render the tampered description."""
        return _broken(broken_povray(self.edit), scene, options, draw)


@dataclass(frozen=True)
class DocumentEdit:
    """The plugins that Mitsuba loads are tampered with, before they become XML or a dictionary."""

    kind: ClassVar[Kind] = "text edit"
    edit: DocumentChange

    def render(
        self, lane: str, scene: Scene, options: RenderOptions, draw: Draw
    ) -> Rendering | None:
        """Render the tampered document."""
        return _broken(broken_mitsuba(lane, self.edit), scene, options, draw)


def _broken(
    renderer: Renderer, scene: Scene, options: RenderOptions, draw: Draw
) -> Rendering | None:
    """Render with what a lane writes tampered with; None where the edit changes nothing."""
    try:
        return draw(renderer, scene, options)
    except NothingToBreakError:
        return None
