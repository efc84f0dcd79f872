"""One rendering as an image file of the user's choice, with its provenance."""

from __future__ import annotations

import json
from collections.abc import Iterable
from dataclasses import asdict
from pathlib import Path
from typing import Any

from crosstrace.harness import images
from crosstrace.harness.display import DisplayRule
from crosstrace.harness.environment import package_version
from crosstrace.harness.sources import Source
from crosstrace.translators import readings as specification
from crosstrace.translators.errors import UsageError
from crosstrace.translators.renderer import Rendering


def readings(settings: Iterable[str]) -> tuple[DisplayRule, dict[str, str]]:
    """Part `name=value` texts into the display rule and the renderer's readings.

    Raises UsageError for a name or value that neither knows.
    """
    display, others = [], []
    for setting in settings:
        name, equals, value = setting.partition("=")
        is_display = name.strip() in ("overflow", "quantise") and equals
        (display if is_display else others).append((name.strip(), value.strip(), setting))
    rule, _ = DisplayRule.split({name: value for name, value, _ in display})
    try:
        return rule, specification.parse(setting for _, _, setting in others)
    except (TypeError, ValueError) as error:
        raise UsageError(str(error)) from error


def save(path: Path, source: Source, lane: str, made: Rendering, rule: DisplayRule) -> dict[str, Any]:
    """Write the image and return a JSON-ready record of it."""
    metadata = provenance(source, lane, made)
    images.write(path, made.image, metadata=metadata, layers=made.layers, rule=rule)
    return {
        "file": str(path),
        "sha256": images.sha256(path),
        "scene": source.name,
        "scene_sha256": source.scene.sha256,
        "renderer": lane,
        "seconds": asdict(made.seconds),
        "half_step": made.half_step,
        "settings": made.settings,
        "messages": made.messages,
    }


def provenance(source: Source, lane: str, made: Rendering) -> dict[str, str]:
    """Return the metadata of an image file."""
    return {
        "version": package_version(),
        "scene": source.name,
        "scene_sha256": source.scene.sha256,
        "renderer": lane,
        "settings": json.dumps(made.settings, default=str),
    }
