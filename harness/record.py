"""The record of a run, `report.json`: the contract from which the page and every verdict are drawn.

`report.schema.json` beside this file documents every key. Judging comes later than measuring, so
`classes`, `verdict` and `blame` hold null or nothing until a judge fills them in; `verdict` is
``incomplete`` where a renderer gave no image. A number that is not finite is null.
"""

from __future__ import annotations

import json
import math
import re
from collections.abc import Mapping
from importlib.resources import files
from pathlib import Path
from typing import Any

from crosstrace.harness import environment
from crosstrace.harness.metrics import THRESHOLDS
from crosstrace.harness.sources import Source
from crosstrace.translators.effects import EFFECTS, effects
from crosstrace.translators.errors import UsageError
from crosstrace.translators.renderer import Probe

SCHEMA = "crosstrace-report/1"

#: The classes of a pixel's difference from truth, in the order of their gravity.
CLASSES = ("equal", "rounding", "undecidable", "model", "suspect", "wrong")

#: Of a ledger entry that concerns many objects, so many indices are kept.
_MOST_OBJECTS = 64


def scene_entry(
    source: Source, renderers: list[dict[str, Any]], pairs: list[dict[str, Any]]
) -> dict[str, Any]:
    """Return the entry of one scene; `renderers` and `pairs` are entries of this module."""
    scene = source.scene
    called_for = effects(scene).names
    complete = all(entry["status"] == "ok" for entry in renderers)
    return {
        "name": source.name,
        "title": source.title,
        "about": source.about,
        "packaged": source.packaged,
        "sha256": scene.sha256,
        "delivery": int(scene.delivery),
        "v_res": scene.v_res,
        "h_res": scene.h_res,
        "max_depth": scene.max_depth,
        "objects": len(scene),
        "lights": scene.n_lights,
        "effects": list(called_for),
        "left_out": [name for name in EFFECTS if name not in called_for],
        "verdict": None if complete else "incomplete",
        "expected": None,
        "blame": [],
        "renderers": renderers,
        "pairs": pairs,
    }


def renderer_entry(lane: str, version: str, result: Mapping[str, Any]) -> dict[str, Any]:
    """Return the entry of one lane's image; `result` is a `store` record or `failure(…)`."""
    entry: dict[str, Any] = {
        "name": lane,
        "version": version,
        "status": "failed",
        "message": "",
        "seconds": {"startup": None, "translate": None, "render": None},
        "peak_mib": None,
        "classes": dict.fromkeys(CLASSES),
        "half_step": None,
        "nonfinite": None,
        "settings": {},
        "messages": [],
        "ledger": [],
        "images": {},
        **result,
    }
    entry["ledger"] = [_ledger_entry(item) for item in entry["ledger"]]
    return entry


def failure(status: str, message: str) -> dict[str, str]:
    """Return the result of a lane that gave no image: missing, failed or unsupported."""
    return {"status": status, "message": message}


def pair_entry(a: str, b: str, numbers: Mapping[str, Any]) -> dict[str, Any]:
    """Return the entry of two lanes; `numbers` is a `store` record or a `message` alone."""
    keys = ("max", "mean", "bias", "rmse", "psnr", "ssim", *THRESHOLDS,
            "pixels", "differing", "nonfinite")  # fmt: skip
    empty = {"message": "", **dict.fromkeys(keys), "worst": [], "images": {}}
    return {"a": a, "b": b, **empty, **numbers}


def report(
    scenes: list[dict[str, Any]], lanes: Mapping[str, Probe], run: Mapping[str, Any]
) -> dict[str, Any]:
    """Return the whole record; `run` says how it was done."""
    about = environment.describe()
    about["renderers"] = [probe_entry(lane, probe) for lane, probe in lanes.items()]
    return dict(
        sanitised({"schema": SCHEMA, "environment": about, "run": dict(run), "scenes": scenes})
    )


def probe_entry(lane: str, probe: Probe) -> dict[str, Any]:
    """Return what a lane says about itself on this machine."""
    return {
        "name": lane,
        "available": probe.available,
        "version": probe.version,
        "reason": probe.reason,
        "remedy": probe.remedy,
    }


def is_complete(record: Mapping[str, Any]) -> bool:
    """Whether every renderer gave an image of every scene and every two were compared."""
    return all(
        all(entry["status"] == "ok" for entry in scene["renderers"])
        and all(pair["pixels"] is not None for pair in scene["pairs"])
        for scene in record["scenes"]
    )


def sanitised(value: Any) -> Any:
    """Return plain JSON data: numbers that are not finite become null, foreign types text.

    Paths of the user's home and of scratch directories are shortened, so that a report can be
    handed on.
    """
    if isinstance(value, Mapping):
        return {str(key): sanitised(item) for key, item in value.items()}
    if isinstance(value, list | tuple | set | frozenset):
        return [sanitised(item) for item in value]
    if isinstance(value, bool | int) or value is None:
        return value
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if hasattr(value, "item"):
        return sanitised(value.item())
    return _without_places(str(value))


def dumps(record: Any) -> str:
    """Write JSON that any reader takes: no NaN, no Infinity, UTF-8 as it is."""
    return json.dumps(sanitised(record), indent=1, ensure_ascii=False, allow_nan=False) + "\n"


def loads(path: str | Path) -> dict[str, Any]:
    """Read a `report.json`; raises UsageError where it is none or of another version."""
    try:
        record = json.loads(Path(path).read_text(encoding="utf-8"))
    except OSError as error:
        raise UsageError(f"{path}: expected a report.json, found: {error.strerror}") from error
    except ValueError as error:
        raise UsageError(f"{path}: expected a report.json, found: {error}") from error
    found = record.get("schema") if isinstance(record, dict) else None
    if found != SCHEMA:
        raise UsageError(f"{path}: expected the schema {SCHEMA}, found {found!r}")
    return dict(record)


def schema() -> dict[str, Any]:
    """Return the JSON Schema of the record."""
    text = (files("crosstrace.harness") / "report.schema.json").read_text(encoding="utf-8")
    return dict(json.loads(text))


def _ledger_entry(entry: Mapping[str, Any]) -> dict[str, Any]:
    objects = list(entry["objects"])
    return {**entry, "objects": objects[:_MOST_OBJECTS], "n_objects": len(objects)}


def _without_places(text: str) -> str:
    home = str(Path.home())
    if home != "/":
        text = text.replace(home, "~")
    return re.sub(r"\S*/crosstrace-[\w-]{8,}", "(scratch)", text)
