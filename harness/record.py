"""The record of a run: what `report.json` holds, by the schema beside this file.

The keys of `report.schema.json` are stable, and the page is drawn from this record alone. A number
that does not exist is null, never NaN or Infinity. No user's name and no absolute path is in it.
"""

from __future__ import annotations

import json
import math
import re
from collections.abc import Iterable, Mapping, Sequence
from datetime import UTC, datetime
from importlib.resources import files
from pathlib import Path
from typing import Any

from crosstrace.harness.classes import NAMES
from crosstrace.harness.environment import describe
from crosstrace.harness.sources import Source
from crosstrace.translators.effects import EFFECTS, effects
from crosstrace.translators.errors import (
    CrosstraceError,
    RendererMissingError,
    UnsupportedSceneError,
    UsageError,
)
from crosstrace.translators.ledger import Entry
from crosstrace.translators.renderer import Probe

SCHEMA = "crosstrace-report/1"

#: Objects that one declaration of a ledger lists by index; their count is always whole.
_LISTED_OBJECTS = 100

#: Keys of a judgement that stand elsewhere in a scene's record.
_PLACED = ("verdict", "blame", "lanes", "images")

_NUMBERS = ("max", "mean", "bias", "rmse", "psnr", "p999", "ssim", "flip", "over_1_255",
            "over_1e_4", "over_1e_9", "pixels", "differing", "nonfinite", "spread")  # fmt: skip


def failed(error: BaseException) -> dict[str, Any]:
    """Return the record of a rendering that gave no image."""
    status = "failed"
    if isinstance(error, RendererMissingError):
        status = "missing"
    elif isinstance(error, UnsupportedSceneError):
        status = "unsupported"
    return {
        "status": status,
        "message": told(error),
        "seconds": {"startup": None, "translate": None, "render": None},
        "peak_mib": None,
        "half_step": None,
        "nonfinite": None,
        "settings": {},
        "messages": [],
        "ledger": [],
        "images": {},
    }


def told(error: BaseException) -> str:
    """Return the text of an error: a foreign one with its type."""
    if isinstance(error, CrosstraceError) and str(error):
        return str(error)
    return f"{type(error).__name__}: {error}"


def not_judged(message: str) -> dict[str, Any]:
    """Return the record of a scene that could not be judged."""
    return {"message": message, "verdict": "incomplete", "blame": [], "lanes": {}, "images": {}}


def not_compared(message: str) -> dict[str, Any]:
    """Return the record of a pair of which an image, or the comparison, is missing."""
    return {**dict.fromkeys(_NUMBERS), "worst": [], "images": {}, "message": message}


def ledger(entries: Iterable[Entry]) -> list[dict[str, Any]]:
    """Return the record of a renderer's declarations about one scene."""
    return [
        {
            "effect": entry.effect,
            "situation": entry.situation,
            "fidelity": entry.fidelity,
            "bound": entry.bound,
            "n_objects": len(entry.objects),
            "objects": [int(i) for i in entry.objects[:_LISTED_OBJECTS]],
            "readings": list(entry.readings),
        }
        for entry in entries
    ]


def scene(
    source: Source,
    renderers: Sequence[Mapping[str, Any]],
    pairs: Sequence[Mapping[str, Any]],
    judged: Mapping[str, Any],
    readings: Mapping[str, str],
) -> dict[str, Any]:
    """Return one scene's record from those of its renderings, comparisons and judgement."""
    it = source.scene
    called_for = effects(it, readings).names
    whole = all(entry["status"] == "ok" for entry in renderers)
    whole = whole and all(pair["pixels"] is not None for pair in pairs)
    lanes = judged["lanes"]
    # A fault that was found stays found, whatever else is missing.
    verdict = judged["verdict"] if whole or judged["blame"] else "incomplete"
    return {
        "name": source.name,
        "title": source.title,
        "about": source.about,
        "packaged": source.packaged,
        "sha256": it.sha256,
        "delivery": it.delivery,
        "v_res": it.v_res,
        "h_res": it.h_res,
        "objects": len(it),
        "lights": it.n_lights,
        "max_depth": it.max_depth,
        "effects": list(called_for),
        "left_out": [name for name in EFFECTS if name not in called_for],
        "verdict": verdict,
        "expected": source.expected,
        "blame": list(judged["blame"]),
        "judgement": {key: value for key, value in judged.items() if key not in _PLACED},
        "renderers": [_judged_lane(entry, lanes.get(entry["name"])) for entry in renderers],
        "pairs": list(pairs),
        "images": dict(judged["images"]),
    }


def _judged_lane(entry: Mapping[str, Any], judged: Mapping[str, Any] | None) -> dict[str, Any]:
    """Return a renderer's record with what is judged of its image."""
    if judged is None:
        nothing: dict[str, Any] = {
            "classes": dict.fromkeys(NAMES),
            "tolerance": None,
            "regions": [],
            "excess": {},
            "declared": [],
        }
        return {**entry, **nothing, "n_regions": None}
    images = dict(entry["images"])
    if judged["image"] is not None:
        images["classes"] = judged["image"]
    names = ("classes", "tolerance", "regions", "n_regions", "declared", "excess")
    kept = {key: judged[key] for key in names}
    return {**entry, **kept, "images": images}


def report(
    scenes: Sequence[Mapping[str, Any]],
    probes: Mapping[str, Probe],
    run: Mapping[str, Any],
) -> dict[str, Any]:
    """Return the whole record, JSON-ready; `run` says how it was made."""
    renderers = [
        {
            "name": lane,
            "available": probe.available,
            "version": probe.version,
            "reason": probe.reason,
            "remedy": probe.remedy,
            "details": dict(probe.details),
        }
        for lane, probe in probes.items()
    ]
    made = {
        "schema": SCHEMA,
        "run": {
            "created": datetime.now(UTC).isoformat(timespec="seconds"),
            "lanes": list(probes),
            **run,
        },
        "environment": {**describe(), "renderers": renderers},
        "scenes": list(scenes),
    }
    plain: dict[str, Any] = _plain(made)
    return plain


def dumps(report: Mapping[str, Any]) -> str:
    """Write a record as JSON in which every number is finite."""
    return json.dumps(_plain(report), indent=1, ensure_ascii=False, allow_nan=False) + "\n"


def loads(path: Path, schema: str = SCHEMA, kind: str = "record") -> dict[str, Any]:
    """Read a `report.json`, or another file of a `schema`; raises UsageError for any other file.

    `kind` is what messages call it.
    """
    try:
        read = json.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise UsageError(f"{path}: cannot be read: {error.strerror}") from error
    except ValueError as error:
        raise UsageError(f"{path}: expected JSON, found: {error}") from error
    found = read.get("schema") if isinstance(read, dict) else type(read).__name__
    if found != schema:
        raise UsageError(f"{path}: expected a {kind} of schema {schema}, found {found!r}")
    loaded: dict[str, Any] = read
    return loaded


def schema() -> dict[str, Any]:
    """Return the JSON Schema of `report.json`."""
    text = (files("crosstrace.harness") / "report.schema.json").read_text(encoding="utf-8")
    parsed: dict[str, Any] = json.loads(text)
    return parsed


def _plain(value: Any) -> Any:
    """Return plain JSON values: numpy's scalars as Python's, numbers not finite as None."""
    if value is None or isinstance(value, bool | int):
        return value
    if isinstance(value, str):
        return _without_places(value)
    if isinstance(value, Mapping):
        return {str(key): _plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple | set | frozenset):
        return [_plain(item) for item in value]
    if isinstance(value, float):
        return float(value) if math.isfinite(value) else None
    return _plain(value.item() if hasattr(value, "item") else str(value))


def _without_places(text: str) -> str:
    """Shorten what would tell a stranger about the machine: scratch directories and the home."""
    text = re.sub(r"/\S*/crosstrace-[\w-]{8,}", "(scratch)", text)
    home = str(Path.home())
    return text if home == "/" else re.sub(rf"{re.escape(home)}(?=/|\W|$)", "~", text)
