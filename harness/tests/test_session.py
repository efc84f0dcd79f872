"""A whole run: what stands in the record and in the directory."""

from __future__ import annotations

import json
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from small_runs import EMPTY, entry_of, run_options

from crosstrace.harness import images
from crosstrace.harness.outcome import exit_status
from crosstrace.harness.schedule import Event
from crosstrace.harness.session import RunOptions, run
from crosstrace.translators.course import load, parse
from crosstrace.translators.registry import LANES
from crosstrace.translators.scene import Scene

GRADIENT, BRIGHTER = "fake_lanes:Gradient", "fake_lanes:Brighter"
PLAIN = "fake_lanes:Plain"


def test_a_run_leaves_record_page_and_every_image_that_the_record_names(
    scene: Scene, tmp_path: Path
) -> None:
    """Each file is there with the hash that the record gives, and nothing else is."""
    report = run([scene], tmp_path / "out", run_options(GRADIENT, BRIGHTER))
    on_disk = json.loads((tmp_path / "out/report.json").read_text(encoding="utf-8"))
    assert on_disk == report
    (entry,) = report["scenes"]
    entries = [entry, *entry["renderers"], *entry["pairs"]]
    named = {i["file"]: i["sha256"] for entry in entries for i in entry["images"].values()}
    found = {
        str(path.relative_to(tmp_path / "out")): images.sha256(path)
        for path in (tmp_path / "out/images").rglob("*")
        if path.is_file()
    }
    assert named == found
    assert {path.name for path in (tmp_path / "out").iterdir()} == {
        "images", "report.html", "report.json", "report.md",
    }  # fmt: skip
    assert [path.name for path in tmp_path.iterdir()] == ["out"]


def test_a_lane_that_draws_another_picture_is_blamed(scene: Scene, tmp_path: Path) -> None:
    """The scene is its background alone: who paints a ramp is wrong, and the status says so."""
    report = run([scene], tmp_path / "out", run_options(PLAIN, GRADIENT))
    (entry,) = report["scenes"]
    assert (entry["verdict"], entry["blame"]) == ("disagree", [GRADIENT])
    assert entry_of(report, PLAIN)["classes"]["equal"] == 12 * 16
    assert entry_of(report, GRADIENT)["classes"]["wrong"] == 12 * 16
    assert exit_status(report) == 1


def test_the_numbers_of_a_pair_are_those_of_its_images(scene: Scene, tmp_path: Path) -> None:
    """One ramp is one per cent brighter than the other, so the difference is 0.01 at its end."""
    report = run([scene], tmp_path / "out", run_options(GRADIENT, BRIGHTER))
    (pair,) = report["scenes"][0]["pairs"]
    assert (pair["a"], pair["b"]) == (GRADIENT, BRIGHTER)
    assert pair["max"] == pytest.approx(0.01, abs=1e-15)
    assert pair["pixels"] == 12 * 16
    ramp = np.maximum(np.linspace(0, 1, 12)[:, None], np.linspace(0, 1, 16)[None, :])
    assert pair["over_1_255"] == int((0.01 * ramp > 1 / 255).sum())
    # The first pixel is black in both.
    assert pair["over_1e_4"] == pair["differing"] == 12 * 16 - 1
    assert pair["bias"] == pytest.approx(-pair["mean"])
    worst = pair["worst"][0]
    assert worst["row"] == 11 or worst["col"] == 15


def test_images_say_what_made_them(scene: Scene, tmp_path: Path) -> None:
    """The EXR holds the pixels as float32 and the scene's hash, the renderer and its version."""
    report = run([scene], tmp_path / "out", run_options(GRADIENT))
    name = entry_of(report, GRADIENT)["images"]["exr"]["file"]
    pixels, metadata = images.read_with_metadata(tmp_path / "out" / name)
    assert pixels[..., 0].max() == 1.0
    assert metadata["crosstrace:scene_sha256"] == scene.sha256
    assert metadata["crosstrace:renderer"] == GRADIENT
    assert metadata["crosstrace:renderer_version"] == "1.0-test"
    assert json.loads(metadata["crosstrace:settings"])["threads"] == 1


def test_scenes_of_one_name_do_not_overwrite_each_other(scene: Scene, tmp_path: Path) -> None:
    """They get different names in the record and different folders."""
    other = replace(scene, background=np.array([9.0, 9, 9]), checked=False)
    strange = replace(scene, name="../a b/<i>")
    report = run([scene, other, strange], tmp_path / "out", run_options(GRADIENT))
    names = [entry["name"] for entry in report["scenes"]]
    assert names == ["scene", "scene-2", "../a b/<i>"]
    files = [entry["renderers"][0]["images"]["png"]["file"] for entry in report["scenes"]]
    assert len(set(files)) == 3
    assert all(
        (tmp_path / "out" / file).resolve().is_relative_to(tmp_path / "out/images")
        for file in files
    )


def test_a_second_run_replaces_the_first_and_touches_nothing_else(
    scene: Scene, tmp_path: Path
) -> None:
    """Images that the new record does not name go, a stranger's file stays."""
    out = tmp_path / "out"
    run([scene, replace(scene, name="old")], out, run_options(GRADIENT))
    (out / "notes.txt").write_text("mine", encoding="utf-8")
    run([scene], out, run_options(GRADIENT))
    assert not (out / "images/old").exists()
    assert (out / "images/scene").is_dir()
    assert (out / "notes.txt").read_text(encoding="utf-8") == "mine"


def test_progress_counts_every_step_up_to_the_total(scene: Scene, tmp_path: Path) -> None:
    """Events come in the caller's thread; a failure is told with its reason."""
    seen: list[Event] = []
    lanes = (GRADIENT, BRIGHTER, "fake_lanes:Absent")
    run([scene], tmp_path / "out", run_options(*lanes), seen.append)
    steps = [event for event in seen if event.kind in ("done", "failed") and event.scene]
    assert [event.done for event in steps] == [1, 2, 3, 4, 5, 6, 7]
    assert {event.total for event in seen} == {7}
    (failure,) = [event for event in seen if event.kind == "failed"]
    assert (failure.what, failure.lane) == ("probe", "fake_lanes:Absent")
    assert "no such program" in failure.message


def test_any_executor_can_stand_in_for_the_pool(scene: Scene, tmp_path: Path) -> None:
    """The run asks for submit alone."""
    with ThreadPoolExecutor(2) as executor:
        report = run([scene], tmp_path / "out", run_options(PLAIN, "native"), executor=executor)
    assert exit_status(report) == 0


def test_a_size_given_overrides_the_resolution(scene: Scene, tmp_path: Path) -> None:
    """The field of view stays, so the scene becomes another one."""
    report = run([scene], tmp_path / "out", run_options(GRADIENT, size=(20, 30)))
    (entry,) = report["scenes"]
    assert (entry["v_res"], entry["h_res"]) == (20, 30)
    assert entry["sha256"] == scene.resized(20, 30).sha256


def test_readings_go_to_the_reference_lane_alone(tmp_path: Path) -> None:
    """The others render the specification's default, whatever is asked of the reference."""
    scene = parse(EMPTY)
    report = run([scene], tmp_path / "out", run_options("native", PLAIN, readings={"tir": "add"}))
    assert report["run"]["readings"] == {"tir": "add"}
    assert entry_of(report, "native")["settings"]["readings"] == {"tir": "add"}
    assert exit_status(report) == 0


def test_the_empty_scene_is_its_background_in_every_lane(tmp_path: Path) -> None:
    """A lane that is missing here says so; the others agree to float32."""
    report = run([parse(EMPTY)], tmp_path / "out", run_options(*LANES))
    for lane in LANES:
        entry = entry_of(report, lane)
        if entry["status"] == "missing":
            assert entry["message"]
            continue
        assert entry["status"] == "ok", entry["message"]
        pixels = images.read(tmp_path / "out" / entry["images"]["exr"]["file"])
        assert np.abs(pixels - np.array([0, 128, 255]) / 255).max() <= 1e-5


def test_the_official_scenes_go_through_every_lane_to_a_report(
    official: Path, tmp_path: Path
) -> None:
    """Where all renderers are installed, every image is there and the exact lanes agree."""
    scenes = [load(path) for path in sorted(official.glob("*.txt"))]
    report = run(scenes, tmp_path / "out", RunOptions(size=(120, 160)))
    assert len(report["scenes"]) == len(scenes) > 0
    for entry in report["scenes"]:
        for lane in entry["renderers"]:
            assert lane["status"] in ("ok", "missing"), lane["message"]
            assert lane["status"] == "missing" or lane["peak_mib"] > 0
        for pair in entry["pairs"]:
            if (pair["a"], pair["b"]) == ("native", "mitsuba-f64") and pair["pixels"]:
                assert pair["over_1e_9"] == 0
