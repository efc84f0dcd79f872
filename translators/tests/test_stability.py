"""What is said about a scene's numerical stability is what is there."""

from __future__ import annotations

from dataclasses import replace
from importlib.resources import as_file, files
from pathlib import Path

import numpy as np
import pytest

from crosstrace.native import _core
from crosstrace.translators.course import load, parse
from crosstrace.translators.native.stability import (
    EPSILONS,
    compare_rungs,
    measure,
    quantiles,
    summary,
)
from crosstrace.translators.native.thresholds import departures
from crosstrace.translators.registry import renderer
from crosstrace.translators.renderer import RenderOptions
from crosstrace.translators.scene import Scene

pytestmark = pytest.mark.skipif(
    "f128" not in _core.precisions(), reason="this platform has no __float128 to compare with"
)

COURSE = files("crosstrace.scenes") / "course"
NAMES = sorted(file.name[:-4] for file in COURSE.iterdir() if file.name.endswith(".txt"))

#: Two planes meet in an edge that the middle column of pixels looks at.
CORNER = (
    "9 11 0.1 1 0 0 0 0 1 0 0 0 1 0 0 0 1 2 "
    "255 0 0 0.5 0.4 0 1 0 0 1 / 0 4 0 1 -1 0 0 255 0 0.5 0.4 0 1 0 0 1 / 0 4 0 -1 -1 0 "
    "255 255 255 1 200 200 200 0 -1 1"
)


def _packaged(name: str) -> Scene:
    with as_file(COURSE / f"{name}.txt") as path:
        return load(path)


@pytest.fixture(scope="module")
def corner() -> Scene:
    return parse(CORNER)


def test_reasons_count_every_undecidable_pixel_and_name_one(corner: Scene) -> None:
    """The column on the edge is open at the first hit, but for the axis, where t is exactly 4."""
    found = measure(corner)
    assert sum(reason.count for reason in found.reasons) == found.known.undecidable.sum() == 8
    first = found.reasons[0]
    assert (first.pixel_class, first.decision, first.depth) == ("edge", "nearest", 0)
    assert first.pixel[1] == 5 and found.known.undecidable[first.pixel]


def test_errors_of_wide_rungs_are_seen_below_double(corner: Scene) -> None:
    """A wider type errs less, and none of them by exactly nothing where double rounds."""
    _, rungs = compare_rungs(corner)
    worst = {rung.precision: float(np.nanmax(rung.error_map)) for rung in rungs}
    assert list(worst) == _core.precisions()
    assert worst == {rung.precision: rung.error["max"] for rung in rungs}
    assert worst["f32"] > 1e-9 > worst["f64"] > 1e-18
    if "f80" in worst:
        assert 1e-18 > worst["f80"] > 1e-22
    assert 1e-28 > worst["dd"] > 0 == worst["f128"]


def test_undecidable_pixels_take_no_part_in_the_error(corner: Scene) -> None:
    """Their map is NaN and the quantiles are those of the rest; without a rest there are none."""
    known, rungs = compare_rungs(corner, ["f64"])
    assert np.array_equal(np.isnan(rungs[0].error_map), known.undecidable)
    assert rungs[0].error == quantiles(rungs[0].error_map[~known.undecidable])
    assert quantiles(np.empty(0)) == {"median": None, "p99": None, "p999": None, "max": None}


def test_another_epsilon_is_compared_with_the_default_one() -> None:
    """At 1e-5 double shows nothing; at 1e-1 shadows that begin a tenth too late are seen."""
    scene = load(Path(str(files("crosstrace.scenes") / "hard" / "more-than-one.txt")))
    changes = measure(scene).epsilons["f64"]
    assert [f"{change.epsilon:g}" for change in changes] == [f"{float(e):g}" for e in EPSILONS]
    assert (changes[4].visible, changes[4].max < 1e-12) == (0, True)
    assert changes[0].visible > 0
    image = renderer("native").render(scene, RenderOptions(readings={"epsilon": "1e-1"})).image
    default = renderer("native").render(scene, RenderOptions()).image
    seen = np.abs(image - default).max(axis=-1) > 1 / 510
    assert changes[0].visible == seen.sum()


def test_the_summary_is_plain_json(corner: Scene) -> None:
    """Numbers, texts and None only: nothing that JSON cannot say."""
    import json

    text = json.dumps(summary(measure(corner)), allow_nan=False)
    assert set(json.loads(text)) >= {"certified_fraction", "undecidable", "rungs", "epsilon"}


def test_a_threshold_that_is_exceeded_or_missing_is_told() -> None:
    """Each excess is a sentence of its own; limits that are just met are kept."""
    _, rungs = compare_rungs(parse(CORNER), ["f64"])
    worst = rungs[0].error_same_tree
    assert worst is not None and rungs[0].changed_decidable == 0
    assert departures(rungs, {"f64": {"changed_trees": 0, "error": worst}}) == []
    (told,) = departures(rungs, {"f64": {"changed_trees": 0, "error": worst / 2}})
    assert told.startswith("f64: expected errors of at most")
    assert departures(rungs, {}) == ["f64: no threshold is stated"]
    changed = [replace(rungs[0], changed_decidable=3), replace(rungs[1], error_same_tree=1e-20)]
    trees, outside = departures(changed, {"f64": {"changed_trees": 2, "error": 1}})
    assert trees == "f64: expected at most 2 changed trees in decidable pixels, found 3"
    assert outside.startswith("f128: expected errors of at most 0 ")


def _keeps_the_course_promise(scene: Scene) -> None:
    _, (double, widest) = compare_rungs(scene, ["f64"])
    assert double.changed_decidable == 0, scene.name
    assert (double.error["max"] or 0.0) <= 1e-12, scene.name
    assert widest.error["max"] == 0.0, scene.name


@pytest.mark.parametrize("name", NAMES)
def test_double_keeps_the_ray_trees_of_the_packaged_scenes(name: str) -> None:
    """In every decidable pixel, with errors of 1e-12 at most: here at a sixteenth of the size."""
    scene = _packaged(name)
    _keeps_the_course_promise(scene.resized(scene.v_res // 16, scene.h_res // 16))


@pytest.mark.slow
@pytest.mark.timeout(3600)
@pytest.mark.parametrize("name", NAMES)
def test_double_keeps_the_ray_trees_at_full_size(name: str) -> None:
    """The same for every pixel of the packaged scenes."""
    _keeps_the_course_promise(_packaged(name))


@pytest.mark.slow
@pytest.mark.timeout(4 * 3600)
def test_double_keeps_the_ray_trees_of_the_official_scenes_at_full_size(official: Path) -> None:
    """The same for the course's own scenes."""
    for path in sorted(official.glob("*.txt")):
        _keeps_the_course_promise(load(path))
