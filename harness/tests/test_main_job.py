"""The main job as a whole: packaged and degenerate scenes through every lane, by the numbers.

The bounds are the project's promises on linear float: what each lane's arithmetic, offset and
output allow. Where one is broken, a renderer, a translator or a scene is at fault, not the bound.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from crosstrace.harness.outcome import exit_status
from crosstrace.harness.session import RunOptions, run
from crosstrace.harness.sources import find, packaged_names
from crosstrace.translators.course import parse

CAMERA = "24 32 0.05 1 0 -6 1.5 0 0 0.8 0 0 1 120 170 230 "
BALL = "200 100 50 0.1 0.6 0.3 20 0.2 0.3 1.5 * 0 0 1 1 "
LIGHTS = "255 255 255 1 200 200 200 -4 -5 6"
DEGENERATE = {
    "nothing at all": CAMERA + "0",
    "no object, delivery 2": CAMERA + "0 255 255 255 1 200 200 200 -4 -5 6",
    "no object, delivery 3": CAMERA + "3 0 255 255 255 0",
    "no light": CAMERA + "2 1 " + BALL + "255 255 255 0",
    "depth 0": CAMERA + "0 1 " + BALL + LIGHTS,
    "one pixel": "1 1" + CAMERA[5:] + "2 1 " + BALL + LIGHTS,
    "one row": "1 32" + CAMERA[5:] + "2 1 " + BALL + LIGHTS,
    "black": CAMERA.replace("120 170 230", "0 0 0") + "1 0 0 0 * 0 0 1 1",
}


def promises(report: dict[str, Any]) -> list[str]:
    """Return what of the promises a report breaks, in words."""
    broken = []
    for scene in report["scenes"]:
        half_step = {lane["name"]: lane["half_step"] for lane in scene["renderers"]}
        for pair in scene["pairs"]:
            if pair["a"] != "native":
                continue
            lane, found = pair["b"], (pair["max"], pair["over_1_255"], pair["over_1e_9"])
            kept = {
                "mitsuba-f64": pair["max"] <= 1e-11 and pair["over_1e_9"] == 0,
                # 0.05 % of the pixels, or the one on an edge of a tiny picture.
                "mitsuba": pair["over_1_255"] <= max(1, 0.0005 * pair["pixels"]),
                "povray": pair["max"] <= half_step["povray"] + 1e-5,
            }
            if not kept[lane]:
                broken.append(f"{scene['name']} by {lane}: {found}")
    return broken


@pytest.mark.timeout(900)
def test_every_packaged_scene_keeps_the_promises_in_every_lane(tmp_path: Path) -> None:
    """All 18 at the specification's 480 × 640: images from all lanes, within their bounds."""
    report = run(find(), tmp_path / "report", RunOptions())
    assert [scene["name"] for scene in report["scenes"]] == list(packaged_names())
    assert len(report["scenes"]) == 18
    assert all(scene["renderers"] and len(scene["pairs"]) == 6 for scene in report["scenes"])
    assert exit_status(report) == 0
    assert promises(report) == []


def test_degenerate_scenes_go_through_every_lane(tmp_path: Path) -> None:
    """No objects, no lights, one pixel, depth 0: an image from each lane, and the same one."""
    from dataclasses import replace

    scenes = [replace(parse(text), name=name) for name, text in DEGENERATE.items()]
    report = run(scenes, tmp_path / "report", RunOptions())
    assert exit_status(report) == 0
    assert promises(report) == []
    assert (tmp_path / "report/report.html").is_file()


@pytest.mark.timeout(600)
def test_a_million_objects_end_in_images_or_in_a_clear_refusal(tmp_path: Path) -> None:
    """A file of a million spheres renders natively; a lane that cannot hold it says so."""
    rows = [f"200 {i % 256} 50 * {i % 1000} {i // 1000} 0 0.4" for i in range(1_000_000)]
    file = tmp_path / "million.txt"
    file.write_text("2 3 0.5 1 500 500 80 500 500 0 0 1 0 9 9 9\n1000000\n" + "\n".join(rows))
    options = RunOptions(lanes=("native", "mitsuba-f64"))
    report = run(find([str(file)]), tmp_path / "report", options)
    native, exact = report["scenes"][0]["renderers"]
    assert native["status"] == "ok"
    assert exact["status"] == "unsupported" and "objects" in exact["message"]
    assert exit_status(report) == 3
