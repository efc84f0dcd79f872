"""`crosstrace bench`: what is measured and how it is told; how fast is nobody's business here."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from command_line import NO_POVRAY, call

from crosstrace.harness import alone
from crosstrace.harness.bench import embree, frames, intersection, native_frames, rows
from crosstrace.harness.bench.measure import bench
from crosstrace.harness.bench.rays import MOST_RAYS, of_picture
from crosstrace.harness.bench.runs import Runs
from crosstrace.harness.bench.spheres import text_of
from crosstrace.harness.jobs import Task, available_cores
from crosstrace.harness.sources import find_one
from crosstrace.translators.course import parse
from crosstrace.translators.errors import RendererError
from crosstrace.translators.native.intersect import nearest

TINY = ("bench", "--scenes", "glass-bench", "--size", "6x8", "--repeat", "2", "--spheres", "0",
        "--quiet")  # fmt: skip
NO_EMBREE = {"CROSSTRACE_EMBREE": "/nonexistent"}


def test_the_record_names_the_machine_and_every_comparison() -> None:
    """Rows have a name, two numbers with their runs, and a ratio; missing ones say so."""
    done = call(*TINY, "--json", env=NO_POVRAY | NO_EMBREE)
    assert done.returncode == 3, done.stderr
    record = json.loads(done.stdout)
    assert record["machine"]["cpu"] and record["machine"]["cores"] >= 1
    assert record["settings"] == {
        "scenes": ["glass-bench"], "spheres": [], "size": [[6, 8]], "repeat": 2,
    }  # fmt: skip
    by_name = {row["name"]: row for row in record["rows"]}
    for row in record["rows"]:
        assert {"name", "ours", "theirs", "ratio", "unit"} <= set(row)
        assert row["ours"] > 0 and len(row["runs"]["ours"]) == 2
    rate = by_name["glass-bench: all rays, 1 thread"]
    assert rate["n_rays"] > 2 * 48 and rate["theirs"] is None
    for lane in ("mitsuba", "mitsuba-f64"):
        row = by_name[f"glass-bench: frame, {lane}"]
        assert row["ratio"] == pytest.approx(row["theirs"] / row["ours"])
    assert by_name["glass-bench: frame, povray"]["status"] == "missing"
    absent = [row for row in record["rows"] if "Embree" in row["name"]]
    assert len(absent) == 3 and {row["status"] for row in absent} == {"missing"}
    assert any("peak" in name for name in by_name)


def test_frames_of_the_native_tracer_are_held_against_each_other() -> None:
    """Vectors against scalars, certainty against both, and two threads against one by the clock."""
    source = find_one("glass-bench", size=(12, 16))
    made = {row["name"]: row for row in native_frames.measure("x", source.scene, 2)}
    vector, by_scalar, by_vector = (
        made[f"x: {name} frame"]
        for name in ("vector frame, scalar", "certified frame, scalar", "certified frame, vector")
    )
    assert vector["runs"]["theirs"] == by_scalar["runs"]["theirs"] and vector["ours"] > 0
    assert by_scalar["runs"]["ours"] == by_vector["runs"]["ours"] and by_scalar["ours"] > 0
    assert by_vector["runs"]["theirs"] == vector["runs"]["ours"]
    if available_cores() > 1:
        threads = made["x: 2 threads for 1"]
        assert len(threads["runs"]["ours"]) == len(threads["runs"]["theirs"]) == 2
        assert threads["runs"]["theirs"] != vector["runs"]["ours"]


def test_a_crowd_of_spheres_is_read_sorted_and_met() -> None:
    """Its rows stand beside the scenes'; Embree's fastest way is there, and the one ray by ray."""
    done = call("bench", "--scenes", "", "--spheres", "300", "--repeat", "1", "--quiet", "--json")
    record = json.loads(done.stdout)
    assert record["settings"]["spheres"] == [300] and record["settings"]["scenes"] == []
    names = [row["name"] for row in record["rows"]]
    assert names[:2] == ["300 spheres: text read", "300 spheres: tree built"]
    is_there = any(True for _ in embree.libraries())
    assert done.returncode == (0 if is_there else 3)
    assert len(set(names)) == len(names) and all(row["ours"] > 0 for row in record["rows"])
    for kind in ("primary", "shadow", "mirrored"):
        of_kind = [
            row for row in record["rows"] if f"300 spheres: {kind} rays, Embree" in row["name"]
        ]
        assert 1 <= len(of_kind) <= 1 + is_there
        if is_there:
            assert of_kind[-1]["name"].endswith(" single")
            assert of_kind[0]["ratio"] <= of_kind[-1]["ratio"]


def test_what_fails_is_a_row_that_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    """The others are measured all the same."""

    def call_in_a_worker(task: Task, name: str, *_: object) -> list[dict[str, Any]]:
        if task.function is native_frames.measure:
            raise RendererError("measuring: its process was ended by SIGKILL")
        return [rows.own(f"{name}: other", Runs([1.0]), "s")]

    monkeypatch.setattr(alone, "call", call_in_a_worker)
    monkeypatch.setattr(frames, "measure", lambda *_: [])
    source = find_one("glass-bench", size=(3, 4))
    made = bench([source], [5], 1, 10.0, lambda *_: None)["rows"]
    assert [row["status"] for row in made] == ["failed", "ok", "ok"]
    assert made[0]["name"] == "glass-bench" and "SIGKILL" in made[0]["message"]


def test_nothing_to_measure_is_wrong_usage() -> None:
    """Neither scenes nor spheres."""
    done = call("bench", "--scenes", "", "--spheres", "0")
    assert done.returncode == 2 and "found neither" in done.stderr


def test_a_crowd_is_the_same_in_every_run_and_fills_the_picture() -> None:
    """Its text is a scene of so many spheres, most of whose primary rays hit one."""
    text = text_of(2000)
    assert text == text_of(2000)
    scene = parse(text)
    assert len(scene) == 2000 and scene.is_sphere.all()
    primary = of_picture(scene.resized(60, 107))[0]
    hit = nearest(scene, primary.origins, primary.directions)[1]
    assert 0.4 < (hit >= 0).mean() < 1


@pytest.fixture
def embrees() -> list[Path | str]:
    """Give the libraries of Embree that are there."""
    found = list(embree.libraries())
    if not found:
        # An optional extra, and the record without it is tested above.
        pytest.skip("neither embreex nor libembree3 is installed")
    return found


@pytest.mark.usefixtures("embrees")
def test_embree_hits_the_same_spheres_of_a_crowd() -> None:
    """In every mode of every version that is there."""
    scene = parse(text_of(2000)).resized(60, 107)
    found = intersection.against_embree("x", scene, of_picture(scene)[:1], 1)
    assert found[0]["same_hits"] and min(found[0]["same_hits"].values()) > 0.99


def test_rays_come_tile_by_tile() -> None:
    """As renderers trace them: the first 256 primary rays are of the picture's first corner."""
    scene = find_one("phong-bench", size=(40, 70)).scene
    primary = of_picture(scene)[0]
    tile, whole = primary.directions[:, :256], primary.directions
    assert np.ptp(tile, axis=1).max() < 0.5 * np.ptp(whole, axis=1).max()
    assert len(np.unique(whole.T, axis=0)) == len(primary)


@pytest.mark.parametrize("text", ["-1", "many", "1,,2", "1e9"])
def test_a_crowd_that_is_no_number_is_wrong_usage(text: str) -> None:
    """Nothing is measured then."""
    done = call("bench", "--spheres", text)
    assert done.returncode == 2 and "expected numbers" in done.stderr


def test_the_table_fits_a_terminal() -> None:
    """No line is wider than 80 characters, and what is missing stands in words."""
    done = call(*TINY, env=NO_POVRAY | NO_EMBREE)
    assert max(map(len, done.stdout.splitlines())) <= 80
    assert "missing" in done.stdout and "\x1b" not in done.stdout


def test_an_unknown_scene_is_wrong_usage() -> None:
    """Nothing is measured then."""
    assert call("bench", "--scenes", "nothing-like-it").returncode == 2


def test_a_ratio_above_one_is_in_our_favour() -> None:
    """Whether times or rates are compared, and medians are what counts."""
    ours, theirs = Runs([1.0, 2.0, 9.0]), Runs([4.0, 8.0, 6.0])
    assert rows.frame("x", "povray", ours, theirs)["ratio"] == 3
    row = rows.embree("x", "primary", theirs, {("4", "single"): ours}, {}, "")
    assert (row["ours"], row["theirs"], row["ratio"]) == (6, 2, 3)


def test_embree_is_measured_by_its_fastest_mode() -> None:
    """The row names it; the others are in the record."""
    modes = {("4.4.0", "single"): Runs([10.0]), ("4.4.0", "packet8"): Runs([20.0])}
    row = rows.embree("x", "primary", Runs([100.0]), modes, {"4.4.0": 1.0}, "")
    assert row["name"].endswith("Embree 4.4.0 packet8") and row["ratio"] == 5
    assert row["modes"] == {"4.4.0 single": 10, "4.4.0 packet8": 20}


def test_the_rays_of_a_picture_are_unit_vectors_and_not_too_many() -> None:
    """Primary rays one a pixel; the others leave what was hit."""
    scene = find_one("glass-bench", size=(30, 40)).scene
    primary, shadow, mirrored = of_picture(scene)
    assert len(primary) == 1200 and len(shadow) == len(mirrored) < 1200
    for rays in (primary, shadow, mirrored):
        assert np.allclose(np.linalg.norm(rays.directions, axis=0), 1)
    large = find_one("glass-bench", size=(3000, 4000)).scene
    assert MOST_RAYS * 0.99 < len(of_picture(large)[0]) <= MOST_RAYS


def test_embree_hits_the_same_objects(embrees: list[Path | str]) -> None:
    """Every mode of every library that is there agrees on nearly all rays, in float32."""
    scene = find_one("glass-bench", size=(33, 41)).scene
    for library in embrees:
        made = embree.Embree(library, scene)
        for rays in of_picture(scene):
            _, hit, _ = nearest(scene, rays.origins, rays.directions)
            for mode in made.modes:
                assert (made.nearest(mode, rays)[0] == hit).mean() > 0.99
        made.close()
