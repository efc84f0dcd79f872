"""What the commands print and write when all is well; JSON has its keys by name."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from command_line import NO_POVRAY, SCENE, call, scene_file

from crosstrace.harness import images
from crosstrace.harness.display import to_8bit
from crosstrace.translators.course import load, parse
from crosstrace.translators.renderer import RenderOptions

LANES = ("native", "mitsuba", "mitsuba-f64", "povray")


@pytest.fixture
def scene(tmp_path: Path) -> Path:
    """Write the small scene."""
    return scene_file(tmp_path)


@pytest.mark.parametrize("suffix", [".npy", ".npz", ".exr", ".pfm", ".png", ".ppm"])
def test_render_writes_the_image_in_the_format_of_the_name(
    scene: Path, tmp_path: Path, suffix: str
) -> None:
    """The file holds what native renders, to the precision of its format."""
    from crosstrace.translators.native.adapter import Native

    expected = Native().render(load(scene), RenderOptions()).image
    done = call("render", scene, "-o", tmp_path / f"x{suffix}")
    assert (done.returncode, done.stdout) == (0, "")
    found = images.read(tmp_path / f"x{suffix}")
    if suffix in (".npy", ".npz"):
        assert np.array_equal(found, expected)
    elif suffix in (".exr", ".pfm"):
        assert np.array_equal(found, expected.astype(np.float32))
    else:
        assert np.array_equal(found * 255, to_8bit(expected))


@pytest.mark.parametrize("lane", LANES)
def test_render_works_with_every_renderer(scene: Path, tmp_path: Path, lane: str) -> None:
    """Each lane gives an image close to native's, and its record in JSON."""
    for name, renderer in (("a", "native"), ("b", lane)):
        done = call("render", scene, "--with", renderer, "-o", tmp_path / f"{name}.npz", "--json")
        assert done.returncode == 0, done.stderr
    record = json.loads(done.stdout)
    assert record["renderer"] == lane
    assert record["scene_sha256"] == load(scene).sha256
    assert set(record["seconds"]) == {"startup", "translate", "render"}
    a, b = (images.read(tmp_path / f"{name}.npz") for name in "ab")
    assert np.median(np.abs(a - b)) < 1e-4


def test_render_offers_the_side_outputs_and_enclosures_by_name(scene: Path, tmp_path: Path) -> None:
    """An .npz holds the side outputs with their shapes, and enclosures that hold the image."""
    done = call("render", scene, "--aov", "--certify", "-o", tmp_path / "x.npz")
    assert done.returncode == 0, done.stderr
    with np.load(tmp_path / "x.npz") as arrays:
        shapes = {name: arrays[name].shape for name in arrays if name != "metadata"}
        assert shapes == {
            "image": (12, 16, 3), "object": (12, 16), "t": (12, 16), "normal": (12, 16, 3),
            "tree": (12, 16), "rays": (12, 16), "contributions": (12, 16, 6, 3),
            "lo": (12, 16, 3), "hi": (12, 16, 3), "undecidable": (12, 16),
        }  # fmt: skip
        assert arrays["tree"].dtype == np.uint64
        assert arrays["undecidable"].dtype == np.bool_
        assert set(np.unique(arrays["object"])) <= {-1, 0, 1}
        assert (arrays["lo"] <= arrays["hi"]).all()


def test_render_takes_readings_of_the_specification_and_of_the_8_bit_image(tmp_path: Path) -> None:
    """`--set` reaches native and the display rule, and another value gives another image."""
    bright = scene_file(tmp_path, SCENE.replace("0.1 0.7 0.3 20", "1 1 1 20"))
    found = {}
    for name, settings in {
        "default": [], "reading": ["depth=minus-one"], "display": ["overflow=clamp"],
        "both": ["depth=minus-one", "overflow=clamp", "quantise=round"],
    }.items():  # fmt: skip
        words = [word for setting in settings for word in ("--set", setting)]
        assert call("render", bright, "-o", tmp_path / f"{name}.png", *words).returncode == 0
        found[name] = images.read(tmp_path / f"{name}.png").tobytes()
    assert len(set(found.values())) == 4


def test_size_keeps_the_field_of_view(scene: Path, tmp_path: Path) -> None:
    """At three times the resolution the centres of the pixel blocks show the same."""
    for name, size in (("small", "12x16"), ("large", "36x48")):
        call("render", scene, "-o", tmp_path / f"{name}.npz", "--size", size)
    small, large = (images.read(tmp_path / f"{name}.npz") for name in ("small", "large"))
    assert large.shape == (36, 48, 3)
    np.testing.assert_allclose(large[1::3, 1::3], small, atol=1e-9)


def test_translate_prints_the_scene_or_writes_it(scene: Path, tmp_path: Path) -> None:
    """Standard output holds the translation alone and can be piped; a file holds the same."""
    for lane, marker in (("povray", "camera"), ("mitsuba", "<scene"), ("native", "*")):
        printed = call("translate", scene, "--to", lane)
        assert printed.returncode == 0, printed.stderr
        assert marker in printed.stdout
        assert "render it with: " in printed.stderr
        written = call("translate", scene, "--to", lane, "-o", tmp_path / "tiny.out", "--quiet")
        assert (written.returncode, written.stdout, written.stderr) == (0, "", "")
        assert (tmp_path / "tiny.out").read_text(encoding="utf-8") == printed.stdout


def test_a_translation_to_the_course_format_reads_back_equal(scene: Path) -> None:
    """`translate --to native` is the writer of the format."""
    assert parse(call("translate", scene, "--to", "native").stdout) == load(scene)


def test_a_translation_names_its_own_file(scene: Path, tmp_path: Path) -> None:
    """The line that renders a translation names the file that was written, inside and outside."""
    done = call("translate", scene, "--to", "povray", "-o", tmp_path / "other.pov")
    assert "+Iother.pov" in (tmp_path / "other.pov").read_text(encoding="ascii")
    assert "other.pov" in done.stderr


def test_compare_says_how_far_two_images_are_apart(tmp_path: Path) -> None:
    """One pixel of a known difference comes out in every number, in JSON and in the table."""
    a = np.zeros((20, 20, 3))
    b = a.copy()
    b[3, 4, 1] = 0.5
    images.write(tmp_path / "a.npy", a)
    images.write(tmp_path / "b.npy", b)
    record = json.loads(call("compare", "a.npy", "b.npy", "--json", cwd=tmp_path).stdout)
    assert (record["a"], record["b"]) == ("a.npy", "b.npy")
    assert (record["max"], record["pixels"]) == (0.5, 400)
    assert record["mean"] == pytest.approx(0.5 / 1200)
    assert record["rmse"] == pytest.approx((0.25 / 1200) ** 0.5)
    assert record["psnr"] == pytest.approx(-20 * np.log10(record["rmse"]))
    assert [record[key] for key in ("over_1_255", "over_1e_4", "over_1e_9")] == [1, 1, 1]
    assert 0 < record["ssim"] < 1
    assert (record["worst"][0]["row"], record["worst"][0]["col"]) == (3, 4)
    table = call("compare", "a.npy", "b.npy", cwd=tmp_path).stdout
    assert "greatest difference" in table and "0.5" in table


def test_compare_never_writes_a_number_that_json_lacks(tmp_path: Path) -> None:
    """Equal images have no PSNR, and one that is not a number has no maximum: both are null."""
    images.write(tmp_path / "a.npy", np.zeros((4, 4, 3)))
    images.write(tmp_path / "b.npy", np.full((4, 4, 3), np.nan))
    same = json.loads(call("compare", "a.npy", "a.npy", "--json", cwd=tmp_path).stdout)
    assert (same["max"], same["psnr"], same["ssim"]) == (0.0, None, None)
    text = call("compare", "a.npy", "b.npy", "--json", cwd=tmp_path).stdout
    assert json.loads(text, parse_constant=_refuse)["max"] is None


def test_compare_with_a_scene_checks_size_and_origin(scene: Path, tmp_path: Path) -> None:
    """An image of another size, or one that says it shows another scene, is refused."""
    call("render", scene, "-o", tmp_path / "x.exr")
    assert call("compare", "x.exr", "x.exr", "--scene", scene, cwd=tmp_path).returncode == 0
    done = call("compare", "x.exr", "x.exr", "--scene", scene, "--size", "24x32", cwd=tmp_path)
    assert done.returncode == 2
    other = scene_file(tmp_path, SCENE.replace("255 0 0", "254 0 0"), "other.txt")
    done = call("compare", "x.exr", "x.exr", "--scene", other, cwd=tmp_path)
    assert (done.returncode, "another scene" in done.stderr) == (2, True)


def test_effects_names_what_each_object_calls_for(scene: Path) -> None:
    """The sphere is lit but mirrors nothing, the plane mirrors, and glass is left out."""
    record = json.loads(call("effects", scene, "--json").stdout)
    sphere = ["ambient", "diffuse", "specular", "shadows"]
    assert [item["index"] for item in record["objects"]] == [0, 1]
    assert record["objects"][0]["effects"] == sphere
    assert record["objects"][1]["effects"] == ["ambient", "diffuse", "shadows", "reflection"]
    assert record["effects"] == [*sphere, "reflection"]
    assert record["left_out"] == ["flat", "refraction", "total_reflection"]
    table = call("effects", scene).stdout
    assert "left out:  flat, refraction, total_reflection" in table


def test_doctor_lists_every_lane_with_version_and_remedy() -> None:
    """Each lane says whether it works; a missing one has a reason and a remedy, the rest stays."""
    record = json.loads(call("doctor", "--json", "--quiet", env=NO_POVRAY).stdout)
    assert record["environment"]["python"]
    lanes = {lane["name"]: lane for lane in record["renderers"]}
    assert tuple(lanes) == LANES
    assert lanes["native"]["available"] and lanes["native"]["version"]
    assert not lanes["povray"]["available"]
    assert lanes["povray"]["reason"] and lanes["povray"]["remedy"] == "apt-get install povray"


def test_run_leaves_a_report_and_prints_the_same_record(scene: Path, tmp_path: Path) -> None:
    """The standard output under `--json` is the report.json, and the table names every lane."""
    out = tmp_path / "out"
    done = call("run", scene, "-o", out, "--renderers", "native,mitsuba-f64", "--json")
    assert done.returncode == 0, done.stderr
    record = json.loads(done.stdout)
    assert record == json.loads((out / "report.json").read_text(encoding="utf-8"))
    assert record["schema"] == "crosstrace-report/1"
    (entry,) = record["scenes"]
    assert [lane["name"] for lane in entry["renderers"]] == ["native", "mitsuba-f64"]
    assert (out / "report.html").is_file()
    assert (out / "report.md").read_text(encoding="utf-8").startswith("### crosstrace")
    table = call("run", scene, "-o", out, "--renderers", "native,mitsuba-f64").stdout
    assert "mitsuba-f64" in table and str(out / "report.html") in table


def test_run_takes_a_tolerance_and_writes_junit(scene: Path, tmp_path: Path) -> None:
    """The tolerance stands in the record; only a finite one from 0 is taken."""
    out, junit = tmp_path / "out", tmp_path / "junit.xml"
    words = ("run", scene, "-o", out, "--renderers", "native", "--size", "6x8")
    done = call(*words, "--tolerance", "1.5e-7", "--junit", junit, "--json")
    assert done.returncode == 0, done.stderr
    made = json.loads(done.stdout)["run"]
    assert (made["tolerance"], made["size"]) == (1.5e-7, [6, 8])
    assert b"crosstrace run" in junit.read_bytes()
    for wrong in ("-1", "nan", "inf", "x"):
        refused = call(*words, "--tolerance", wrong)
        assert refused.returncode == 2 and "Traceback" not in refused.stderr


def test_run_without_a_renderer_says_so_and_reports_the_rest(scene: Path, tmp_path: Path) -> None:
    """A missing lane stands in table and record as missing, the scene as incomplete: status 3."""
    out = tmp_path / "out"
    words = ("run", scene, "-o", out, "--renderers", "native,mitsuba-f64,povray")
    done = call(*words, env=NO_POVRAY)
    assert done.returncode == 3
    assert "povray missing: " in done.stdout
    (entry,) = json.loads((out / "report.json").read_text(encoding="utf-8"))["scenes"]
    assert entry["verdict"] == "incomplete"
    assert [lane["status"] for lane in entry["renderers"]] == ["ok", "ok", "missing"]


def test_report_draws_the_page_again(scene: Path, tmp_path: Path) -> None:
    """The page drawn from the record is the one that the run left."""
    call("run", scene, "-o", tmp_path, "--renderers", "native")
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    (tmp_path / "report.html").unlink()
    assert call("report", tmp_path / "report.json").returncode == 0
    assert (tmp_path / "report.html").read_text(encoding="utf-8") == page


def _refuse(name: str) -> None:
    raise AssertionError(f"{name} is not JSON")
