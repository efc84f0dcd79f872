"""Draws `report.html` from a `report.json` and the files that it names by hash, into one file.

The page needs no other file and no network, and says so to the browser: its policy lets nothing be
loaded, and only the script that was put in here run. The templates show; this file only prepares.
"""

from __future__ import annotations

import base64
import hashlib
import json
import shlex
from collections import Counter
from collections.abc import Iterable, Mapping
from importlib.resources import files
from pathlib import Path
from typing import Any

from jinja2 import Environment, FunctionLoader, StrictUndefined
from markupsafe import Markup

from crosstrace.harness import blame, colormap, maps
from crosstrace.harness.classes import NAMES
from crosstrace.harness.outcome import outcome, sentence
from crosstrace.harness.page import plots
from crosstrace.harness.page.numbers import FILTERS
from crosstrace.harness.page.payload import Payload, payload
from crosstrace.harness.sources import bench_names, hard_names
from crosstrace.harness.spread import EDGES, TEXTS

_STYLES = ("report.css", "overview.css", "viewer.css")

#: In the order in which they build on each other.
_SCRIPTS = ("base.js", "unpack.js", "layers.js", "viewport.js", "inspector.js", "input.js",
            "viewer.js", "playground.js", "overview.js")  # fmt: skip

#: Letters of the classes, in their order: what colour says, they say, too.
LETTERS = ("", "R", "U", "M", "S", "W")

#: Pixels of a page, in bytes: what comes after so much is told to be left out. 18 scenes of 480 x
#: 640 in four lanes take 12 million; a browser opens ten times that in some seconds.
LARGEST_PAYLOAD = 120_000_000

#: What is worth looking at first.
_ORDER = ("departs", "incomplete", "expected", "explained", "agree")

_SAYING = {
    "departs": "not as expected",
    "incomplete": "incomplete",
    "expected": "wrong as expected",
    "explained": "explained",
    "agree": "agree",
}


def page(report: Mapping[str, Any], folder: Path) -> str:
    """Return the page as HTML text.

    `report` is a record of `record.report`, whose files are looked for in `folder`; a file that is
    missing or another one is told on the page.
    """
    environment = Environment(
        loader=FunctionLoader(_text),
        autoescape=True,
        # A misspelled key must not become an empty text.
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters |= FILTERS
    script = "\n".join(_text(name) for name in _SCRIPTS)
    digest = base64.b64encode(hashlib.sha256(f"\n{script}\n".encode()).digest()).decode()
    room, scenes = LARGEST_PAYLOAD, []
    for scene in sorted(report["scenes"], key=lambda scene: _ORDER.index(_group(scene))):
        pixels = payload(scene, folder)
        if pixels.size > room:
            pixels = pixels.reduced()
        room -= pixels.size
        scenes.append(_scene(scene, report["run"], pixels))
    return environment.get_template("report.html.j2").render(
        report=report,
        scenes=scenes,
        groups=_groups(scenes),
        lanes=report["run"]["lanes"],
        summary=_summary(report),
        study=_study(report.get("study")),
        style=Markup("\n".join(_text(name) for name in _STYLES)),
        script=Markup(script),
        script_hash=digest,
        constants=_json(_constants(report, scenes)),
        gradient=colormap.css_gradient(),
        classes=list(zip(NAMES, LETTERS, _css(colormap.CLASS_COLORS), strict=True)),
        difference_ticks=colormap.difference_ticks(),
    )


def _css(colors: Iterable[tuple[int, int, int]]) -> list[str]:
    return [f"rgb({r} {g} {b})" for r, g, b in colors]


def _text(name: str) -> str:
    return (files("crosstrace.harness.page") / name).read_text(encoding="utf-8")


def _json(value: Any) -> Markup:
    """Return JSON that ends no script element, whatever names are in it."""
    text = json.dumps(value, separators=(",", ":"), ensure_ascii=False, allow_nan=False)
    for character in "<>&\u2028\u2029":
        text = text.replace(character, f"\\u{ord(character):04x}")
    return Markup(text)


def _constants(report: Mapping[str, Any], scenes: Iterable[Mapping[str, Any]]) -> dict[str, Any]:
    """Return what the script must know of the scales and the judgement."""
    return {
        "ramp": colormap.ramp_table().tolist(),
        "classes": list(NAMES),
        "letters": LETTERS,
        "classColors": colormap.CLASS_COLORS,
        "undefinedColor": colormap.NOT_A_NUMBER,
        "steps": maps.STEPS,
        "leastDifference": maps.LEAST_DIFFERENCE,
        "leastUnlike": maps.LEAST_UNLIKE,
        "most": maps.MOST,
        "allDigits": maps.ALL_DIGITS,
        "undefined": maps.UNDEFINED,
        "edges": EDGES,
        "edgeTexts": TEXTS,
        "suspectPixels": blame.SUSPECT_PIXELS,
        "suspectShare": blame.SUSPECT_SHARE,
        "undecidableShare": blame.UNDECIDABLE_SHARE,
        "lanes": report["run"]["lanes"],
        "scenes": [_judged(scene) for scene in scenes],
        "tolerance": report["run"].get("tolerance", 0.0),
    }


def _judged(scene: Mapping[str, Any]) -> dict[str, Any]:
    """Return what says how a scene would come out under another tolerance."""
    lanes = scene["renderers"]
    truth = scene["judgement"].get("truth") or {}
    return {
        "name": scene["name"],
        "group": scene["group"],
        "open": truth.get("undecidable", 0),
        "violations": truth.get("float128_outside", 0),
        "pixels": scene["v_res"] * scene["h_res"],
        "excess": {lane["name"]: lane["excess"] for lane in lanes},
        "undecidable": {lane["name"]: lane["classes"]["undecidable"] for lane in lanes},
    }


def _scene(scene: Mapping[str, Any], run: Mapping[str, Any], pixels: Payload) -> dict[str, Any]:
    lanes = {entry["name"]: entry for entry in scene["renderers"]}
    pairs = {(pair["a"], pair["b"]): pair for pair in scene["pairs"]}
    first = next(iter(lanes), None)
    compared = [(b, pair) for (a, b), pair in pairs.items()
                if a == first and pair["pixels"] is not None]  # fmt: skip
    title = f"{scene['name']}: differences from {first}"
    group = _group(scene)
    name = scene["name"]
    return {
        **scene,
        "lanes": lanes,
        "by_pair": pairs,
        "to_first": [pair for (a, _), pair in pairs.items() if a == first],
        "sentence": sentence(scene),
        "outcome": outcome(scene),
        "group": group,
        "saying": _SAYING[group],
        "troubles": [entry for entry in lanes.values() if entry["status"] != "ok"],
        "picture": pixels.picture,
        "missing": pixels.troubles,
        "data": _json(
            pixels.data
            | {
                "name": name,
                "tolerances": {lane: entry["tolerance"] for lane, entry in lanes.items()},
                "ledger": {lane: entry["ledger"] for lane, entry in lanes.items()},
                "command": _command(scene, run),
            }
        ),
        "curves": plots.curves(title, compared) if compared else "",
        "histogram": plots.histogram(title, compared) if compared else "",
        "slowest": max((_seconds(entry) for entry in lanes.values()), default=0.0),
    }


def _seconds(entry: Mapping[str, Any]) -> float:
    return sum(value or 0.0 for value in entry["seconds"].values())


def _group(scene: Mapping[str, Any]) -> str:
    found = outcome(scene)
    if found != "fine":
        return found
    return scene["verdict"] if scene["verdict"] in ("explained", "agree") else "expected"


def _groups(scenes: Iterable[Mapping[str, Any]]) -> list[tuple[str, str, int]]:
    counted = Counter(scene["group"] for scene in scenes)
    return [(group, _SAYING[group], counted[group]) for group in _ORDER if counted[group]]


def _command(scene: Mapping[str, Any], run: Mapping[str, Any]) -> dict[str, str]:
    """Return the parts of a line that explains a pixel: before its row and column, and after."""
    # Where a file of the user's stands is not in the record.
    by_name = scene["packaged"] or scene["name"] in (*hard_names(), *bench_names())
    name = scene["name"] if by_name else f"{scene['name']}.txt"
    options = [f"--set {shlex.quote(f'{k}={v}')}" for k, v in run["readings"].items()]
    if run.get("size"):
        options.append(f"--size {scene['v_res']}x{scene['h_res']}")
    return {"start": f"crosstrace explain {shlex.quote(name)}", "end": " ".join(options)}


def _study(study: Mapping[str, Any] | None) -> dict[str, Any] | None:
    """Return a study with its picture as an image: markup of a record's is never put in as such."""
    if study is None:
        return None
    encoded = base64.b64encode(study.get("svg", "").encode()).decode()
    picture = f"data:image/svg+xml;base64,{encoded}" if encoded else ""
    return {**study, "picture": picture}


def _summary(report: Mapping[str, Any]) -> dict[str, Any]:
    entries = [entry for scene in report["scenes"] for entry in scene["renderers"]]
    lanes = []
    for about in report["environment"]["renderers"]:
        mine = [entry for entry in entries if entry["name"] == about["name"]]
        done = [entry for entry in mine if entry["status"] == "ok"]
        stages = {
            stage: sum(entry["seconds"][stage] or 0.0 for entry in done)
            for stage in ("startup", "translate", "render")
        }
        peak = max((entry["peak_mib"] for entry in done), default=None)
        lanes.append({**about, "wanted": len(mine), "done": len(done), **stages, "peak_mib": peak})
    return {
        "lanes": lanes,
        "images": sum(lane["done"] for lane in lanes),
        "wanted": len(entries),
        "incomplete": sum(
            scene["verdict"] == "incomplete"
            or any(lane["status"] != "ok" for lane in scene["renderers"])
            for scene in report["scenes"]
        ),
        "any_packaged": any(scene["packaged"] for scene in report["scenes"]),
    }
