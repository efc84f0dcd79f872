"""Draws `report.html` from a `report.json` alone: no pixels are read, no network is used.

The template shows; this file only prepares: numbers as short texts, pairs by their lanes, colours
of the fixed scales.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from importlib.resources import files
from typing import Any
from urllib.parse import quote

import numpy as np
from jinja2 import Environment, FunctionLoader, StrictUndefined
from markupsafe import Markup

from crosstrace.harness import colormap
from crosstrace.harness.outcome import outcome, sentence
from crosstrace.harness.record import CLASSES


def page(report: Mapping[str, Any]) -> str:
    """Return the page as HTML text; `report` is a record of `record.report`."""
    environment = Environment(
        loader=FunctionLoader(_text),
        autoescape=True,
        # A misspelled key must not become an empty text.
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters |= {
        "sig": significant,
        "count": count,
        "swatch": swatch,
        "link": link,
        "seconds": seconds,
        "similarity": similarity,
        "mib": lambda value: "–" if value is None else f"{value:.0f}",
    }
    return environment.get_template("report.html.j2").render(
        report=report,
        scenes=[_scene(scene) for scene in report["scenes"]],
        lanes=report["run"]["lanes"],
        summary=_summary(report),
        style=Markup(_text("report.css")),
        gradient=colormap.css_gradient(),
        classes=list(zip(CLASSES, _css(colormap.CLASS_COLORS), strict=True)),
        difference_ticks=colormap.difference_ticks(),
        similarity_ticks=colormap.similarity_ticks(),
    )


def _css(colors: Iterable[tuple[int, int, int]]) -> list[str]:
    return [f"rgb({r} {g} {b})" for r, g, b in colors]


def significant(value: float | None, digits: int = 2) -> str:
    """Return a number in few characters: 0, 0.034, 3.4e-7; a dash for none."""
    if value is None:
        return "–"
    if value == 0 or not math.isfinite(value):
        return f"{value:g}"
    if 1e-3 <= abs(value) < 1e5:
        return f"{value:.{digits}g}" if abs(value) < 10 else f"{value:.{digits + 2}g}"
    mantissa, _, exponent = f"{value:.{digits - 1}e}".partition("e")
    return f"{mantissa}e{int(exponent)}"


def seconds(value: float | None) -> str:
    """Return seconds to the millisecond, or to a tenth from ten on; a dash for none."""
    if value is None:
        return "–"
    return f"{value:.3f}" if value < 10 else f"{value:.1f}"


def similarity(value: float | None) -> str:
    """Return an SSIM so that only exactly 1 reads as 1: 0.999964, 1 − 3e-9."""
    if value is None or value == 1:
        return "–" if value is None else "1"
    return f"1 − {significant(1 - value, 1)}" if value > 1 - 5e-7 else f"{value:.6f}"


def count(value: int | None) -> str:
    """Return a count with thin spaces between thousands; a dash for none."""
    return "–" if value is None else f"{value:,}".replace(",", "\u202f")


def swatch(value: float | None) -> str:
    """Return the colour that the difference scale gives to a value, as CSS."""
    position = np.array([[math.nan if value is None else value]])
    red, green, blue = colormap.difference_picture(position)[0, 0]
    return f"rgb({red} {green} {blue})"


def link(name: str) -> str:
    """Return a relative file name as a URL that can be nothing else."""
    return quote(name, safe="/")


def _text(name: str) -> str:
    return (files("crosstrace.harness.page") / name).read_text(encoding="utf-8")


def _scene(scene: Mapping[str, Any]) -> dict[str, Any]:
    lanes = {entry["name"]: entry for entry in scene["renderers"]}
    pairs = {(pair["a"], pair["b"]): pair for pair in scene["pairs"]}
    first = next(iter(lanes), None)
    return {
        **scene,
        "lanes": lanes,
        "by_pair": pairs,
        "to_first": [pair for (a, _), pair in pairs.items() if a == first],
        "sentence": sentence(scene),
        "outcome": outcome(scene),
        "troubles": [entry for entry in lanes.values() if entry["status"] != "ok"],
    }


def _summary(report: Mapping[str, Any]) -> dict[str, Any]:
    entries = [entry for scene in report["scenes"] for entry in scene["renderers"]]
    lanes = []
    for about in report["environment"]["renderers"]:
        mine = [entry for entry in entries if entry["name"] == about["name"]]
        done = [entry for entry in mine if entry["status"] == "ok"]
        lanes.append(
            {
                **about,
                "wanted": len(mine),
                "done": len(done),
                "startup": sum(entry["seconds"]["startup"] for entry in done),
                "translate": sum(entry["seconds"]["translate"] for entry in done),
                "render": sum(entry["seconds"]["render"] for entry in done),
                "peak_mib": max((entry["peak_mib"] for entry in done), default=None),
            }
        )
    done = sum(lane["done"] for lane in lanes)
    return {
        "lanes": lanes,
        "images": done,
        "wanted": len(entries),
        "incomplete": sum(
            scene["verdict"] == "incomplete"
            or any(lane["status"] != "ok" for lane in scene["renderers"])
            for scene in report["scenes"]
        ),
        "any_packaged": any(scene["packaged"] for scene in report["scenes"]),
    }
