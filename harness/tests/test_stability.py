"""`crosstrace stability`: what it prints and writes, and when it fails."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from command_line import NO_POVRAY, call, scene_file

from crosstrace.harness import images, stability
from crosstrace.harness.sources import Source, find_one
from crosstrace.harness.stability import Options
from crosstrace.native import _core

KEYS = {"name", "certified_fraction", "undecidable", "rungs"}


def studied(source: Source, options: Options) -> stability.Entry:
    (entry,) = stability.entries([source], options.size)
    for _ in stability.study([entry], options):
        pass
    return entry


def test_json_has_the_stable_keys(tmp_path: Path) -> None:
    """One scene, every precision of the platform, errors as numbers or null."""
    done = call("stability", scene_file(tmp_path), "--json", "-q")
    assert done.returncode == 0, done.stderr
    (scene,) = json.loads(done.stdout)["scenes"]
    assert set(scene) >= KEYS and scene["name"] == "tiny"
    assert [rung["precision"] for rung in scene["rungs"]] == _core.precisions()
    for rung in scene["rungs"]:
        assert set(rung) >= {"precision", "changed_trees", "error", "seconds"}
        assert set(rung["error"]) == {"median", "p99", "p999", "max"}
    assert scene["certified_fraction"] == 1.0 and scene["stable"] is None
    assert len(scene["epsilon"]["f64"]) == 13
    assert "metamorphic" not in scene


def test_the_table_fits_a_terminal_and_says_what_is_open() -> None:
    """80 columns; the open decision, its object and a pixel stand there."""
    done = call("stability", "edge-centres", "-q")
    assert (done.returncode, done.stdout) == (0, "")
    done = call("stability", "edge-centres")
    assert max(map(len, done.stdout.splitlines())) <= 80
    assert "99.13 % certified, 43 undecidable" in done.stdout
    assert "25 open: nearest, object 0, depth 0, first at row 0, column 40" in done.stdout


def test_large_scenes_are_measured_smaller_and_say_so() -> None:
    """480 rows become 120 with the same view; --size is taken as it is."""
    source = find_one("canto")
    (entry,) = stability.entries([source], None)
    assert entry.scene.shape == (120, 160, 3) and not entry.at_own_size
    assert entry.scene.pixel_size == source.scene.pixel_size * 4
    (entry,) = stability.entries([source], (6, 8))
    assert entry.scene.shape == (6, 8, 3)
    done = call("stability", "canto", "--size", "6x8")
    assert "canto, 6x8 of 480x640: 100 % certified" in done.stdout


def test_pictures_and_record_are_written(tmp_path: Path) -> None:
    """A map of classes, the digits lost, and one of errors for each precision."""
    done = call("stability", "edge-centres", "-o", tmp_path / "out", "-q")
    assert done.returncode == 0, done.stderr
    (scene,) = json.loads((tmp_path / "out/stability.json").read_text())["scenes"]
    written = sorted(path.name for path in (tmp_path / "out").iterdir())
    assert written == sorted([*scene["pictures"], "stability.json"])
    assert {f"edge-centres-error-{name}.png" for name in _core.precisions()} <= set(written)
    assert "edge-centres-digits-f64.png" in written
    certified = images.read(tmp_path / "out/edge-centres-certified.png")
    dark = (certified == np.array([24, 32, 78]) / 255).all(axis=-1)
    assert (~dark).sum() == scene["undecidable"] == 43


def test_a_directory_that_cannot_be_is_refused_first(tmp_path: Path) -> None:
    """A file in its place, an unknown scene, or a renderer without a check: bad input."""
    file = scene_file(tmp_path)
    assert call("stability", file, "-o", file).returncode == 2
    assert call("stability", "no-such-scene").returncode == 2
    done = call("stability", file, "--renderers", "povray")
    assert (done.returncode, "--metamorphic" in done.stderr) == (2, True)


def test_a_scene_beyond_its_thresholds_fails() -> None:
    """Status 1 and a sentence; at another size nothing was promised."""
    source = find_one("edge-centres")
    stated = {name: dict(limits) for name, limits in source.stable.items()}
    stated["f64"]["changed_trees"] = 0
    strict = replace(source, stable=stated)
    entry = studied(strict, Options())
    (told,) = entry.departures
    assert told.startswith("f64: expected at most 0 changed trees")
    assert stability.exit_status([entry]) == 1
    assert stability.record([entry])["scenes"][0]["stable"] is False
    entry = studied(strict, Options(size=(30, 41)))
    assert stability.exit_status([entry]) == 0
    assert stability.record([entry])["scenes"][0]["stable"] is None


def test_what_takes_too_long_is_reported() -> None:
    """A job without a result is a failure with its reason, in the record and the status."""
    entry = studied(find_one("edge-centres"), Options(timeout_s=1e-3))
    assert "timed out" in entry.failures["rungs"]
    assert stability.exit_status([entry]) == 3
    (scene,) = stability.record([entry])["scenes"]
    assert set(scene) >= KEYS and scene["certified_fraction"] is None and scene["rungs"] == []


def test_metamorphic_checks_are_told_and_a_missing_renderer_is_no_pass(tmp_path: Path) -> None:
    """The table has a row for each change; POV-Ray, missing, makes the status 3."""
    file = scene_file(tmp_path)
    words = ("stability", file, "--metamorphic", "--renderers", "native,povray")
    done = call(*words, env=NO_POVRAY)
    assert done.returncode == 3
    assert max(map(len, done.stdout.splitlines())) <= 80 or "povray:" in done.stdout
    for name in ("scale-1024", "order", "split-lights", "rotate"):
        assert any(line.startswith(name) for line in done.stdout.splitlines())
    assert "tiny: povray:" in done.stdout


@pytest.mark.parametrize("over", [0, 1])
def test_a_broken_check_fails(over: int) -> None:
    """One pixel beyond its bound is a disagreement."""
    from crosstrace.harness.metamorphic import Outcome

    (entry,) = stability.entries([find_one("canto")], None)
    entry.outcomes["native"] = [Outcome("axes", "native", "f64", 9, 9, over, 1e-3, 1e-9, False)]
    assert stability.exit_status([entry]) == over
    assert stability.record([entry])["scenes"][0]["metamorphic"][0]["over"] == over
