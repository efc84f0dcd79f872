"""`crosstrace effects --prove`: the images with and without what is left out."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from command_line import NO_POVRAY, SCENE, call, scene_file

from crosstrace.harness.proof import prove
from crosstrace.translators.course import parse
from crosstrace.translators.renderer import RenderOptions


@pytest.fixture
def scene(tmp_path: Path) -> Path:
    """Write a small scene of delivery 3."""
    return scene_file(tmp_path)


def test_gated_and_ungated_images_are_the_same(scene: Path) -> None:
    """Native and Mitsuba give the same bits, POV-Ray the same samples; effects have times."""
    done = call("effects", scene, "--prove", "--repeat", "1", "--json", "--quiet")
    record = json.loads(done.stdout)
    lanes = {lane["name"]: lane for lane in record["renderers"] if lane["status"] == "ok"}
    assert {"native", "mitsuba", "mitsuba-f64"} <= set(lanes)
    assert record["identical"]
    for lane in lanes.values():
        assert lane["equal"] and set(lane["seconds"]) == {"gated", "ungated"}
        assert set(lane["cost_seconds"]) == set(record["effects"])
        assert set(lane["left_out_seconds"]) == {"refraction", "total_reflection"}
    assert all(lanes[name]["identical"] for name in ("native", "mitsuba", "mitsuba-f64"))
    assert set(record["saved_seconds"]) == set(lanes)


def test_the_table_fits_a_terminal(scene: Path) -> None:
    """Every line of the proof is at most 80 characters wide."""
    words = ("effects", scene, "--prove", "--repeat", "1", "--renderers", "native,mitsuba-f64")
    done = call(*words, "--quiet")
    assert done.returncode == 0, done.stderr
    assert "identical" in done.stdout and "costs (ms)" in done.stdout
    assert max(map(len, done.stdout.splitlines())) <= 80


def test_a_missing_renderer_is_no_proof(scene: Path) -> None:
    """The others are proven, the missing one is named, and the exit status is 3."""
    words = ("effects", scene, "--prove", "--repeat", "1", "--renderers", "native,povray", "--json")
    done = call(*words, env=NO_POVRAY)
    record = json.loads(done.stdout)
    assert done.returncode == 3
    assert {lane["name"]: lane["status"] for lane in record["renderers"]} == {
        "native": "ok",
        "povray": "missing",
    }


def test_a_difference_of_one_bit_is_found() -> None:
    """A renderer whose own choice of effects changes the image ever so little is not equal."""
    (made,) = prove(
        parse(SCENE), ["fake_lanes:Forgetful"], RenderOptions(), 1, lambda lane, share: None
    )
    assert made["status"] == "ok"
    assert not made["identical"] and not made["equal"]
    assert made["max_difference"] == 2.0**-40


def test_other_readings_cannot_be_proven(scene: Path) -> None:
    """Most renderers take the default readings only, so --set is wrong usage here."""
    done = call("effects", scene, "--prove", "--set", "tir=ignore")
    assert done.returncode == 2
