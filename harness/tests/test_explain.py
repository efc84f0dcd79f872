"""`crosstrace explain` and its Python call: rays, truth and every lane's value at one pixel."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pytest
from command_line import NO_POVRAY, SCENE, call, fake_povray, scene_file

import crosstrace as ct
from crosstrace.harness import explain_text
from crosstrace.translators.native.explain import RayKind

#: Two planes that meet at an irrational distance under the only pixel: red or green.
EDGE = "1 1 1 1 0 1 5 0 0 0 0 1 0 0 0 51 2 255 0 0 / 0 0 0 1 0 1 0 255 0 / 0 0 0 -1 0 1"


@pytest.fixture
def scene(tmp_path: Path) -> ct.Scene:
    """Read the small scene."""
    return ct.load(scene_file(tmp_path))


def test_every_lane_stands_beside_the_enclosure(scene: ct.Scene) -> None:
    """Values are those of the lanes' images, and differences tell how far outside they lie."""
    found = ct.explain(scene, 10, 7)
    assert found.complete
    assert [lane.name for lane in found.lanes] == list(ct.LANES)
    assert found.enclosure is not None
    lo, hi = np.array(found.enclosure.lo), np.array(found.enclosure.hi)
    assert (lo <= hi).all() and (hi - lo).max() < 1e-9
    for lane in found.lanes:
        assert lane.value == tuple(ct.render(scene, lane.name)[10, 7])
        outside = np.maximum(0, lane.value - hi) - np.maximum(0, lo - lane.value)
        assert lane.difference == tuple(outside)
        assert lane.alternative is None
        assert lane.verdict in ("equal", "rounding", "model")
    by_name = {lane.name: lane for lane in found.lanes}
    assert by_name["native"].difference == (0, 0, 0)
    assert 0 < max(map(abs, by_name["mitsuba"].difference or ())) < 1e-4
    assert by_name["povray"].half_step


def test_native_alone_starts_no_other_lane(scene: ct.Scene) -> None:
    """Its value is the tree's colour, which is the image's to the last bit."""
    found = ct.explain(scene, 10, 7, lanes=["native"])
    (lane,) = found.lanes
    assert lane.value == found.tree.color == tuple(ct.render(scene)[10, 7])
    assert found.tree.rays[0].kind == RayKind.PRIMARY


def test_readings_reach_tree_truth_and_native(scene: ct.Scene) -> None:
    """Under another reading the three agree with each other, and on another value."""
    plain = ct.explain(scene, 10, 7, ["native"])
    other = ct.explain(scene, 10, 7, ["native"], {"depth": "minus-one"})
    assert other.tree.color != plain.tree.color
    assert other.lanes[0].difference == (0, 0, 0)
    assert other.record()["readings"] == {"depth": "minus-one"}


def test_a_reading_without_truth_leaves_the_rest(scene: ct.Scene) -> None:
    """offset=bound has no enclosure; tree and values are there."""
    found = ct.explain(scene, 10, 7, ["native"], {"offset": "bound"})
    assert found.enclosure is None and found.complete
    assert found.lanes[0].difference is None
    assert found.record()["enclosure"] is None
    assert "offset=bound" in "\n".join(explain_text.lines(found))


def test_an_undecidable_pixel_is_told_with_its_alternatives(tmp_path: Path) -> None:
    """A lane's difference is that from the nearest possible value, and it is named."""
    found = ct.explain(ct.load(scene_file(tmp_path, EDGE)), 0, 0, ["native"])
    assert found.enclosure is not None
    assert len(found.enclosure.alternatives) == 2
    for value, expected in (((1, 0, 0), 0), ((0, 1, 0), 0), ((0.5, 0, 0), 0.5)):
        difference, alternative = found.enclosure.difference(value) or ((9.0, 9.0, 9.0), None)
        assert max(map(abs, difference)) == pytest.approx(expected, abs=1e-15)
        assert alternative in (0, 1)
    record = found.record()
    assert record["enclosure"]["class"] == "edge"
    assert record["enclosure"]["decision"] == "nearest"
    assert record["lanes"][0]["alternative"] in (0, 1)
    text = "\n".join(explain_text.lines(found))
    assert "undecidable" in text and "first hit 0 at depth 0" in text and "1: greatest" in text


@pytest.mark.parametrize(("lane", "status"), [
    ("Absent", "missing"), ("Refusing", "unsupported"), ("Crashing", "failed"),
    ("Wrongly", "failed"),
])  # fmt: skip
def test_a_lane_without_an_image_is_told_in_its_row(
    scene: ct.Scene, lane: str, status: str
) -> None:
    """The others keep their values."""
    found = ct.explain(scene, 10, 7, ["native", f"fake_lanes:{lane}", "fake_lanes:Gradient"])
    assert [entry.status for entry in found.lanes] == ["ok", status, "ok"]
    assert found.lanes[1].message and found.lanes[1].value is None
    assert not found.complete


def test_a_lane_that_hangs_is_given_up(scene: ct.Scene) -> None:
    """The limit is stated in its row."""
    found = ct.explain(scene, 10, 7, ["native", "fake_lanes:Hanging"], timeout_s=1.5)
    assert found.lanes[1].status == "failed"
    assert "timed out after 1.5 s" in found.lanes[1].message


def test_a_value_that_is_no_number_is_null(scene: ct.Scene) -> None:
    """JSON never holds NaN."""
    found = ct.explain(scene, 0, 0, ["fake_lanes:Undefined"])
    (lane,) = found.record()["lanes"]
    assert lane["value"][0] is None and lane["difference"] is None
    assert math.isnan((found.lanes[0].value or (0,))[0])


@pytest.mark.parametrize(("row", "col"), [(12, 0), (0, 16), (-1, 0), (0, -1)])
def test_a_pixel_outside_is_refused(scene: ct.Scene, row: int, col: int) -> None:
    """Before any lane is started."""
    with pytest.raises(ct.UsageError, match="expected 0 to"):
        ct.explain(scene, row, col)


def test_the_command_prints_a_tree_that_a_terminal_holds(tmp_path: Path) -> None:
    """Rays are indented under the hits that they leave, in at most 100 columns, in plain text."""
    scene_file(tmp_path)
    done = call("explain", "tiny.txt", 10, 7, "--renderers", "native", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    lines = done.stdout.splitlines()
    assert max(map(len, lines)) <= 100 and "\x1b" not in done.stdout
    assert lines[0].startswith("tiny: row 10, column 7 of 12x16, rays: ")
    table = lines[next(i for i, line in enumerate(lines) if line.startswith("ray ")) + 1 :]
    assert table[0].startswith("primary ")
    assert table[1].startswith("  light 0 ")
    assert any(line.startswith("  reflected ") for line in table)


def test_the_command_prints_its_record_in_json(tmp_path: Path) -> None:
    """The keys are stable, every ray is there, and options reach the scene."""
    scene_file(tmp_path)
    words = ("explain", "tiny.txt", 20, 17, "--size", "24x32", "--delivery", "3", "--json", "-q",
             "--renderers", "native,mitsuba-f64")  # fmt: skip
    done = call(*words, cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    record = json.loads(done.stdout, parse_constant=_refuse)
    scene = ct.load(tmp_path / "tiny.txt", size=(24, 32))
    assert record["schema"] == "crosstrace-explain/1"
    assert record["scene"] == {"name": "tiny", "sha256": scene.sha256}
    assert (record["row"], record["col"]) == (20, 17)
    assert record["color"] == ct.render(scene)[20, 17].tolist()
    assert int(record["tree"], 16) == ct.render_full(scene, layers=True).layers["tree"][20, 17]
    assert len(record["rays"]) == record["n_rays"] > 2
    assert {"kind", "parent", "depth", "object", "light", "margin", "margin_decision",
            "margin_object", "inside", "total", "weight", "t_world", "light_distance", "origin",
            "direction", "point", "normal", "color", "base", "diffuse", "specular", "unsent",
            "clearance"} == set(record["rays"][0])  # fmt: skip
    assert [ray["kind"] for ray in record["rays"]][:2] == ["primary", "shadow"]
    assert record["enclosure"]["class"] == "certified"
    assert set(record["lanes"][1]) == {"name", "status", "message", "value", "half_step",
                                       "difference", "alternative", "class"}  # fmt: skip
    assert record["lanes"][0]["class"] == "equal"


def test_a_missing_lane_ends_with_3_and_the_rest_is_shown(tmp_path: Path) -> None:
    """The row of the lane says what is missing and how to install it."""
    scene_file(tmp_path)
    words = ("explain", "tiny.txt", 10, 7, "--renderers", "native,povray")
    done = call(*words, cwd=tmp_path, env=NO_POVRAY)
    assert done.returncode == 3
    assert "povray        missing: " in done.stdout and "apt-get install povray" in done.stdout
    assert "primary" in done.stdout and "certified" in done.stdout


def test_a_lane_that_fails_ends_with_3(tmp_path: Path) -> None:
    """A crash of POV-Ray is told in words beside the values of the others."""
    scene_file(tmp_path)
    words = ("explain", "tiny.txt", 10, 7, "--renderers", "native,povray", "--json", "-q")
    done = call(*words, cwd=tmp_path, env=fake_povray(tmp_path, "kill -SEGV $$"))
    assert done.returncode == 3
    native, povray = json.loads(done.stdout)["lanes"]
    assert (native["status"], povray["status"]) == ("ok", "failed")
    assert povray["value"] is None and povray["message"]


def test_a_malformed_scene_is_refused_in_words(tmp_path: Path) -> None:
    """With file, line and column, as everywhere."""
    scene_file(tmp_path, SCENE.replace("* 0 0 1 1", "* 0 0 1 -1"))
    done = call("explain", "tiny.txt", 0, 0, cwd=tmp_path)
    assert done.returncode == 2
    assert "tiny.txt:7:" in done.stderr and "Traceback" not in done.stderr


def test_a_tree_of_thousands_of_rays_is_cut_in_print_and_whole_in_json(tmp_path: Path) -> None:
    """The last lines say how many rays are left out; depths beyond the indent stand in brackets."""
    shell = "0 0 0 0 0 0 1 .5 .5 1.5 * 0 0 0 1 0 0 0 0 0 0 1 .5 .5 1.3 * 0 0 0 .5"
    scene = ct.load(scene_file(tmp_path, f"1 1 1 1 0 0 5 0 0 0 0 1 0 9 9 9 12 2 {shell} 0 0 0 0"))
    found = ct.explain(scene, 0, 0, ["native"])
    lines = list(explain_text.lines(found))
    assert len(found.record()["rays"]) == found.tree.n_rays > 600
    assert len(lines) < explain_text.MOST_RAYS + 20
    assert any("more rays" in line for line in lines)
    assert any("(12)" in line for line in lines)
    assert max(map(len, lines)) <= 100


def _refuse(name: str) -> None:
    raise AssertionError(f"{name} is not JSON")
