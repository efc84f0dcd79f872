"""`crosstrace study`: the ladder, the advice, what is printed, written, or missing."""

from __future__ import annotations

import json
import re
import shlex
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from command_line import NO_POVRAY, SCENE, call, scene_file

from crosstrace.harness.sources import find_one
from crosstrace.harness.study import experiment, references
from crosstrace.harness.study.errors import measured
from crosstrace.native import _core
from crosstrace.translators.course import parse

KEYS = {"renderer", "settings", "seconds", "error", "kind", "pareto"}


def studied(name: str, **options: Any) -> experiment.Entry:
    how = experiment.Options(**{"lanes": ("native",), "runs": 3, "samples": 2, **options})
    (entry,) = experiment.entries([find_one(name)], how.size)
    for _ in experiment.study([entry], how):
        pass
    assert not entry.failures
    return entry


@pytest.fixture(scope="module")
def glass() -> experiment.Entry:
    """Study the packaged glass scene, natively and small."""
    return studied("vidro4", size=(30, 40), samples=8)


def worst(entry: experiment.Entry, kind: str, key: str) -> dict[Any, float]:
    """Return setting → greatest error of the points of a kind in double, or of every precision."""
    return {
        point["settings"][key]: point["error"]["max"]
        for point in entry.points
        if point["kind"] == kind
        and (key == "precision" or point["settings"]["precision"] == "f64")
    }  # fmt: skip


def test_the_rungs_stand_in_the_order_of_their_digits(glass: experiment.Entry) -> None:
    """float is off by an edge, double by its last places, wider types by theirs."""
    error = worst(glass, "rounding", "precision")
    assert list(error) == _core.precisions()
    assert error["f32"] > 1e-6
    assert error["f64c"] <= error["f64"] < 1e-12
    for wide, most in (("f80", 1e-15), ("dd", 1e-28)):
        if wide in error:
            assert 0 < error[wide] < most
    if "f128" in error:
        assert error["f128"] == 0.0
    (certified,) = [point for point in glass.points if point["kind"] == "certified"]
    assert error["f64"] < certified["error"]["max"] < 1e-9 < error["f32"]


def test_bounces_bring_the_image_nearer_to_the_deep_one(glass: experiment.Entry) -> None:
    """Below the scene's depth and above it, at more rays each; the scene's own is far from it."""
    error = worst(glass, "depth", "max_depth")
    assert list(error) == list(range(len(error))) and len(error) > 10
    assert all(error[d + 2] < error[d] for d in range(len(error) - 2))
    assert error[glass.scene.max_depth] > 1e-3
    rays = [point["rays"] for point in glass.points if point["kind"] == "depth"]
    assert rays == sorted(rays) and len(set(rays)) == len(rays)


def test_epsilon_is_harmless_between_too_large_and_too_small(glass: experiment.Entry) -> None:
    """A plateau of rounding errors, and a cliff at the end where a ray meets its own surface."""
    error = worst(glass, "offset", "epsilon")
    assert all(error[float(text)] < 1e-12 for text in ("1e-4", "1e-6", "1e-8", "1e-10"))
    assert error[1e-14] > 1e-2


def test_samples_bring_the_image_nearer_to_the_average(glass: experiment.Entry) -> None:
    """More of them, regular or jittered; adaptive ones are as good for fewer rays."""
    some = {point["settings"].get("sampling"): point for point in glass.points
            if point["kind"] == "sampling" and point["settings"]["precision"] == "f64"}  # fmt: skip
    rmse = {how: point["error"]["rmse"] for how, point in some.items()}
    for kind in ("regular", "jittered"):
        assert rmse[f"{kind}:8"] < rmse[f"{kind}:4"] < rmse[f"{kind}:2"] < rmse["regular:1"]
    assert rmse["adaptive:8"] < 1.1 * rmse["regular:8"]
    assert some["adaptive:8"]["rays"] < 0.9 * some["regular:8"]["rays"]
    assert rmse["jittered:8"] > 3 * glass.references["average"]["standard_error_rmse"]


def test_pruning_keeps_its_promise(glass: experiment.Entry) -> None:
    """No error beyond the tolerance."""
    error = worst(glass, "pruning", "tolerance")
    assert error and all(worst <= tolerance + 1e-12 for tolerance, worst in error.items())


def test_every_run_is_kept(glass: experiment.Entry) -> None:
    """Three at least beside the warm-up; the time told is their median."""
    for point in glass.points:
        assert len(point["runs"]) >= 3 and point["warm_up"] > 0
        assert min(point["runs"]) <= point["seconds"] <= max(point["runs"])
        assert point["seconds"] == point["wall_seconds"] == float(np.median(point["runs"]))
        assert len(point["processor_runs"]) == len(point["runs"])


def test_the_front_of_a_kind_holds_its_fastest_and_its_most_exact(glass: experiment.Entry) -> None:
    """Whatever the clock says; and nothing is on it that another of its kind beats."""
    for kind in {point["kind"] for point in glass.points}:
        some = [(p["seconds"], p["error"]["rmse"], p["pareto"]) for p in glass.points
                if p["kind"] == kind]  # fmt: skip
        assert min(some)[2]
        assert min(error for _, error, _ in some) in [error for _, error, on in some if on]
        for seconds, error, on in some:
            beaten = any(s < seconds and e < error for s, e, _ in some)
            assert not (on and beaten)


@pytest.mark.parametrize(
    "wish", [("--want", "1e-4"), ("--budget", "10s"), ("--want", "0.02", "--kind", "sampling"),
             ("--want", "1e-7", "--metric", "max")],
)  # fmt: skip
def test_the_advice_does_what_it_promises(tmp_path: Path, wish: tuple[str, ...]) -> None:
    """The command in the sentence is run as it stands, and its image has the error stated."""
    path = scene_file(tmp_path, name="my scene.txt")
    words = ("study", path.name, "--renderers", "native", "--size", "18x24", "--samples", "4")
    done = call(*words, "--runs", "3", "--json", "-q", *wish, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    made = json.loads(done.stdout)
    (about,) = made["scenes"]
    advised = about["advised"]
    line = re.search(r"run `(.*)`\.$", made["advice"])
    assert line and advised and line[1] == advised["command"]
    program, *rest = shlex.split(line[1])
    assert program == "crosstrace"
    assert call(*rest, cwd=tmp_path).returncode == 0
    image = np.load(tmp_path / "image.npy")
    scene = parse(SCENE).resized(18, 24)
    if advised["kind"] == "sampling":
        value, _ = references.average(scene, 8, 1)
    else:
        value, _ = references.certified(scene, 1)
    metric = made["metric"]
    got = getattr(measured(image, 0.0, value), metric)
    assert got == pytest.approx(advised["error"][metric], rel=1e-6, abs=2e-16)
    if "--want" in wish:
        assert got <= float(wish[1])


def test_json_has_the_stable_keys_and_the_files_say_the_same(tmp_path: Path) -> None:
    """study.json, study.svg, and a report whose `study` is that record with the picture."""
    done = call("study", scene_file(tmp_path), "--renderers", "native", "--samples", "2",
                "--runs", "3", "--json", "-o", tmp_path / "out")  # fmt: skip
    assert done.returncode == 0, done.stderr
    made = json.loads(done.stdout)
    assert made["points"] and all(set(point) >= KEYS for point in made["points"])
    for point in made["points"]:
        assert set(point["error"]) == {"max", "rmse", "p999", "wrong_8bit"}
    assert isinstance(made["advice"], str)
    assert json.loads((tmp_path / "out/study.json").read_text()) == made
    report = json.loads((tmp_path / "out/report.json").read_text())
    svg = (tmp_path / "out/study.svg").read_text()
    assert report["study"] == {**made, "svg": svg}
    assert svg.startswith("<svg ")
    # Without a terminal progress is lines.
    assert re.search(r"^\[\d+/\d+\] timing tiny ", done.stderr, re.M) and "\x1b" not in done.stderr


def test_tables_fit_a_terminal(tmp_path: Path) -> None:
    """80 columns at most, but for the sentence of advice, which holds a command to copy."""
    done = call("study", scene_file(tmp_path), "--renderers", "native", "--samples", "2")
    assert done.returncode == 0, done.stderr
    *lines, advice = done.stdout.strip().splitlines()
    assert max(map(len, lines)) <= 80
    assert "rounding, against the certified value" in done.stdout
    assert advice.startswith("For an RMSE of at most 0.00196")


def test_a_missing_renderer_is_reported_and_the_rest_goes_on(tmp_path: Path) -> None:
    """Exit status 3, its reason once, and points of the others."""
    done = call("study", scene_file(tmp_path), "--renderers", "native,povray", "--samples", "2",
                "--runs", "3", "--json", "-q", env=NO_POVRAY)  # fmt: skip
    assert done.returncode == 3
    made = json.loads(done.stdout)
    assert {point["renderer"] for point in made["points"]} == {"native"}
    assert set(made["scenes"][0]["failures"]) == {"povray"}


@pytest.mark.parametrize(
    "words", [("--want", "1e-4", "--budget", "1s"), ("--budget", "soon"), ("--samples", "33"),
              ("--kind", "luck"), ("--want", "0")],
)  # fmt: skip
def test_wishes_that_make_no_sense_are_refused(tmp_path: Path, words: tuple[str, ...]) -> None:
    """Exit status 2 before anything is rendered."""
    done = call("study", scene_file(tmp_path), *words)
    assert done.returncode == 2 and "Traceback" not in done.stderr


@pytest.mark.parametrize(
    "words", [("--max-depth", "2", "first"), ("--sampling", "regular:0", "tiny"),
              ("--sampling", "regular:2", "--aov", "tiny"), ("--tune", "x=1", "tiny"),
              ("--with", "mitsuba", "--sampling", "adaptive:2", "tiny")],
)  # fmt: skip
def test_settings_that_a_renderer_lacks_are_refused(tmp_path: Path, words: tuple[str, ...]) -> None:
    """`render` says so; no image is written."""
    scene_file(tmp_path, name="tiny.txt")
    scene_file(tmp_path, "2 2 1 1 0 0 1 0 1 1 0 0 1 0 0 0 0\n", "first.txt")
    *options, name = words
    done = call("render", f"{name}.txt", *options, "-o", "x.npz", cwd=tmp_path)
    assert done.returncode == 2, done.stderr
    assert "Traceback" not in done.stderr and not (tmp_path / "x.npz").exists()
