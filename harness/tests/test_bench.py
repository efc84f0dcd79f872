"""`crosstrace bench`: what is measured and how it is told; how fast is nobody's business here."""

from __future__ import annotations

import json

import numpy as np
import pytest
from command_line import NO_POVRAY, call

from crosstrace.harness.bench import embree, rows
from crosstrace.harness.bench.measure import Runs
from crosstrace.harness.bench.rays import MOST_RAYS, of_picture
from crosstrace.harness.sources import find_one
from crosstrace.translators.native.intersect import nearest

TINY = ("bench", "--scenes", "glass-bench", "--size", "6x8", "--repeat", "2", "--quiet")
NO_EMBREE = {"CROSSTRACE_EMBREE": "/nonexistent"}


def test_the_record_names_the_machine_and_every_comparison() -> None:
    """Rows have a name, two numbers with their runs, and a ratio; missing ones say so."""
    done = call(*TINY, "--json", env=NO_POVRAY | NO_EMBREE)
    assert done.returncode == 3, done.stderr
    record = json.loads(done.stdout)
    assert record["machine"]["cpu"] and record["machine"]["cores"] >= 1
    assert record["settings"] == {"scenes": ["glass-bench"], "size": [[6, 8]], "repeat": 2}
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


def test_embree_hits_the_same_objects() -> None:
    """Every mode of every library that is there agrees on nearly all rays, in float32."""
    scene = find_one("glass-bench", size=(33, 41)).scene
    found = False
    for library in embree.libraries():
        made = embree.Embree(library, scene)
        for rays in of_picture(scene):
            _, hit, _ = nearest(scene, rays.origins, rays.directions)
            for mode in made.modes:
                assert (made.nearest(mode, rays)[0] == hit).mean() > 0.99
        made.close()
        found = True
    if not found:
        pytest.skip("neither embreex nor libembree3 is installed")
