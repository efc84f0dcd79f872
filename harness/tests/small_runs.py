"""The smallest runs that have a verdict: a scene of its background alone, and what came of it."""

from __future__ import annotations

from typing import Any

from crosstrace.harness.session import RunOptions
from crosstrace.translators.scene import Scene

#: `sky()` as a file: delivery 1 without an object, the header and the number of objects.
EMPTY = "12 16 1 10  0 0 10  0 0 0  0 1 0  0 128 255  0"


def sky(**more: Any) -> Scene:
    """Return the smallest scene whose images have an SSIM, with fields of one's own."""
    fields: dict[str, Any] = {
        "delivery": 1, "v_res": 12, "h_res": 16, "pixel_size": 1.0, "screen_distance": 10.0,
        "eye": [0, 0, 10], "target": [0, 0, 0], "up": [0, 1, 0], "background": [0, 128, 255],
    }  # fmt: skip
    return Scene.build(**{**fields, **more})


def run_options(*lanes: str, **more: Any) -> RunOptions:
    """Return options for two jobs at once and a minute an image, unless `more` says otherwise."""
    return RunOptions(lanes, **{"jobs": 2, "timeout_s": 60.0, **more})


def entry_of(report: dict[str, Any], lane: str, scene: int = 0) -> dict[str, Any]:
    """Return what a report says of a lane's image of a scene."""
    found: dict[str, Any] = next(
        entry for entry in report["scenes"][scene]["renderers"] if entry["name"] == lane
    )
    return found
