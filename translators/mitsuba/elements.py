"""A Mitsuba scene as plain data: written as XML without Mitsuba, or handed to `mi.load_dict`.

Numbers keep their 64 bits both ways: XML holds them as Python prints them, and a dictionary hands
them over as Mitsuba's double types.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any
from xml.sax.saxutils import quoteattr


@dataclass(frozen=True)
class Point:
    """Three coordinates in world units, or a colour that a plugin of ours reads."""

    values: tuple[float, float, float]


@dataclass(frozen=True)
class Rgb:
    """A colour in 0…1 for a stock plugin."""

    values: tuple[float, float, float]


@dataclass(frozen=True)
class Matrix:
    """A transformation, 4 × 4 numbers row by row."""

    values: tuple[float, ...]


@dataclass(frozen=True)
class Reference:
    """The id of an element that stands elsewhere in the scene."""

    id: str


Value = bool | int | float | str | Point | Rgb | Matrix | Reference


@dataclass(frozen=True)
class Element:
    """One plugin: its XML tag, plugin name, id, parameters and nested plugins.

    Ids and parameter names are this project's own words; no text of a scene's author gets in.
    """

    tag: str
    plugin: str
    id: str
    values: dict[str, Value] = field(default_factory=dict)
    children: tuple[Element, ...] = ()


def to_dict(elements: Iterable[Element], mi: Any) -> dict[str, Any]:
    """Return the argument of `mi.load_dict`; `mi` is the module with its variant set."""
    return {"type": "scene"} | {element.id: _entry(element, mi) for element in elements}


def _entry(element: Element, mi: Any) -> dict[str, Any]:
    values = {name: _object(value, mi) for name, value in element.values.items()}
    children = {child.id: _entry(child, mi) for child in element.children}
    return {"type": element.plugin, "id": element.id} | values | children


def _object(value: Value, mi: Any) -> Any:
    match value:
        case Point(values):
            return mi.ScalarPoint3d(list(values))
        case Rgb(values):
            return {"type": "rgb", "value": list(values)}
        case Matrix(values):
            rows = [list(values[4 * i : 4 * i + 4]) for i in range(4)]
            return mi.ScalarTransform4d(rows)
        case Reference(name):
            return {"type": "ref", "id": name}
        case _:
            return value


def to_xml(elements: Iterable[Element], comment: str) -> str:
    """Return the text of a scene file; the comment must not hold two hyphens in a row."""
    lines = ['<?xml version="1.0" encoding="utf-8"?>', f"<!-- {comment} -->"]
    lines.append('<scene version="3.0.0">')
    for element in elements:
        lines += _element_lines(element, "    ")
    return "\n".join([*lines, "</scene>", ""])


def _element_lines(element: Element, indent: str) -> list[str]:
    head = f"{indent}<{element.tag} type={quoteattr(element.plugin)} id={quoteattr(element.id)}"
    inner = [f"{indent}    {_tag(name, value)}" for name, value in element.values.items()]
    for child in element.children:
        inner += _element_lines(child, indent + "    ")
    return [f"{head}>", *inner, f"{indent}</{element.tag}>"] if inner else [f"{head}/>"]


def _tag(name: str, value: Value) -> str:
    key = f"name={quoteattr(name)}"
    match value:
        case bool():
            tag = f'<boolean {key} value="{str(value).lower()}"/>'
        case int():
            tag = f'<integer {key} value="{value}"/>'
        case float():
            tag = f'<float {key} value="{value!r}"/>'
        case Point((x, y, z)):
            tag = f'<point {key} x="{x!r}" y="{y!r}" z="{z!r}"/>'
        case Rgb(values):
            tag = f'<rgb {key} value="{", ".join(map(repr, values))}"/>'
        case Matrix(values):
            tag = f'<transform {key}><matrix value="{" ".join(map(repr, values))}"/></transform>'
        case Reference(target):
            tag = f"<ref {key} id={quoteattr(target)}/>"
        case _:
            tag = f"<string {key} value={quoteattr(value)}/>"
    return tag
