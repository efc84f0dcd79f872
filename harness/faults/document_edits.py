"""Edits of the document that a Mitsuba lane writes (`translators/mitsuba/document.py`).

The document is edited as the plugins and parameters that both its XML and the dictionary for
`mi.load_dict` are written from. Each edit returns a new document, equal where there is nothing to
break.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import cast

from crosstrace.translators.mitsuba.elements import Element, Matrix, Point, Value

Document = list[Element]


def one_bounce_fewer(document: Document) -> Document:
    """Take one from the integrator's max_depth."""

    def shallower(values: dict[str, Value]) -> dict[str, Value]:
        return {"max_depth": max(0, cast(int, values["max_depth"]) - 1)}

    return _changed(document, "max_depth", shallower)


def without_total_reflection(document: Document) -> Document:
    """Let materials and integrator forget what happens where Δ < 0."""

    def forgotten(values: dict[str, Value]) -> dict[str, Value]:
        names = cast(str, values["effects"]).split()
        return {"effects": " ".join(name for name in names if name != "total_reflection")}

    unknown = _changed(document, "total_reflection", lambda values: {"total_reflection": False})
    return _changed(unknown, "effects", forgotten)


def without_a_light(document: Document) -> Document:
    """Leave out the first light that is not black."""
    for position, element in enumerate(document):
        if element.tag == "emitter" and any(cast(Point, element.values["color"]).values):
            return document[:position] + document[position + 1 :]
    return document


def without_the_last_object(document: Document) -> Document:
    """Stop writing one object too early."""
    places = [k for k, e in enumerate(document) if e.id.startswith("object_")]
    if places:
        return document[: places[-1]] + document[places[-1] + 1 :]
    integrator = document[0]
    return [replace(integrator, children=integrator.children[:-1]), *document[1:]]


def radii_off(document: Document) -> Document:
    """Multiply every object's radius by 1.001."""

    def wider(values: dict[str, Value]) -> dict[str, Value]:
        return {"radius": 1.001 * cast(float, values["radius"])}

    return _changed(document, "radius", wider)


def normals_turned(document: Document) -> Document:
    """Flip the normals of all shapes: the third column of a disk, a switch of a sphere."""

    def turned(element: Element) -> Element:
        if element.plugin == "disk":
            numbers = cast(Matrix, element.values["to_world"]).values
            other = Matrix(tuple(-v if k % 4 == 2 else v for k, v in enumerate(numbers)))
            return replace(element, values=element.values | {"to_world": other})
        if element.plugin == "sphere":
            return replace(element, values=element.values | {"flip_normals": True})
        return element

    return [turned(element) for element in document]


def _changed(
    document: Document, name: str, change: Callable[[dict[str, Value]], dict[str, Value]]
) -> Document:
    """Change the values of every plugin that has one of this name, but for the shell around."""

    def visit(element: Element) -> Element:
        mine = name in element.values and element.id != "background"
        return replace(
            element,
            values=element.values | change(element.values) if mine else element.values,
            children=tuple(map(visit, element.children)),
        )

    return [visit(element) for element in document]
