"""Renderers whose own text is tampered with after it was written: what a translator's bug does.

Everything else is the honest lane's: its limits, its program, its reading of the output.
"""

from __future__ import annotations

from collections.abc import Callable, Collection
from typing import TYPE_CHECKING

from crosstrace.translators.renderer import Renderer
from crosstrace.translators.scene import Scene

if TYPE_CHECKING:
    from crosstrace.translators.mitsuba.elements import Element

#: Takes the scene and the text written for it, returns the text that POV-Ray reads.
TextChange = Callable[[Scene, str], str]

#: Takes the plugins written for a scene, returns those that Mitsuba loads.
DocumentChange = Callable[["list[Element]"], "list[Element]"]


class NothingToBreakError(Exception):
    """The edit left the text as it was."""


def broken_povray(edit: TextChange) -> Renderer:
    """Return the lane `povray` with an edit of every description that it writes."""
    from crosstrace.translators.povray import adapter, picture

    class Broken(adapter.PovRay):
        def text(self, analysis: picture.Analysis, output_scale: float) -> str:
            honest = super().text(analysis, output_scale)
            wrong = edit(analysis.plan.scene, honest)
            if wrong == honest:
                raise NothingToBreakError
            return wrong

    return Broken()


def broken_mitsuba(lane: str, edit: DocumentChange) -> Renderer:
    """Return a Mitsuba lane with an edit of every document that it writes."""
    from crosstrace.translators.mitsuba import adapter

    class BrokenStock(adapter.MitsubaStock):
        def document(self, scene: Scene, called_for: Collection[str]) -> list[Element]:
            return _edited(edit, super().document(scene, called_for))

    class BrokenExact(adapter.MitsubaExact):
        def document(self, scene: Scene, called_for: Collection[str]) -> list[Element]:
            return _edited(edit, super().document(scene, called_for))

    broken: dict[str, type[Renderer]] = {"mitsuba": BrokenStock, "mitsuba-f64": BrokenExact}
    return broken[lane]()


def _edited(edit: DocumentChange, honest: list[Element]) -> list[Element]:
    wrong = edit(honest)
    if wrong == honest:
        raise NothingToBreakError
    return wrong
