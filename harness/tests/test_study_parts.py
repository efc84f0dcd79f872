"""The parts of a study that need no renderer: fronts, advice, errors, tables, the picture."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET
from dataclasses import asdict, replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from crosstrace.harness.study import points as study_points
from crosstrace.harness.study import table
from crosstrace.harness.study.advice import Wish, advise
from crosstrace.harness.study.axes import Axis, decades
from crosstrace.harness.study.errors import Error, Value, half_widths, measured
from crosstrace.harness.study.labels import Labels
from crosstrace.harness.study.pareto import front
from crosstrace.harness.study.picture import picture
from crosstrace.harness.study.points import Point, plan
from crosstrace.harness.study.timing import _goes_on, spread
from crosstrace.translators.sampling import Sampling
from crosstrace.translators.scene import Scene, plane

SVG = "{http://www.w3.org/2000/svg}"
COSTS = st.floats(0, 10, allow_nan=False) | st.integers(0, 3).map(float)


def point(renderer: str = "native", kind: str = "rounding", **changes: Any) -> dict[str, Any]:
    """Return a point's record."""
    error = changes.pop("error", 1e-3)
    known = {
        "scene": "tiny", "renderer": renderer, "settings": {}, "label": "f64", "kind": kind,
        "against": study_points.AGAINST[kind], "own_rules": False, "seconds": 0.1, "spread": 0.0,
        "rays": 12345, "error": asdict(Error(10 * error, error, 2 * error, 7)), "pareto": False,
        "command": f"crosstrace render tiny --with {renderer}",
    }  # fmt: skip
    return {**known, **changes}


def scene(delivery: int = 3, kr: float = 0.5) -> Scene:
    stated = {"ka": 0.1, "kd": 0.5, "kr": kr}
    material = {name: stated[name] for name in list(stated)[: (0, 2, 3)[delivery - 1]]}
    return Scene.build(
        delivery=delivery, v_res=3, h_res=4, pixel_size=0.1, screen_distance=1.0,
        eye=np.array([0.0, 0.0, 1.0]), target=np.array([0.0, 1.0, 0.9]),
        up=np.array([0.0, 0.0, 1.0]), background=np.zeros(3), max_depth=2 if delivery == 3 else 0,
        objects=[plane((255, 0, 0), (0, 0, 0), (0, 0, 1), **material)],
        lights=[((255, 255, 255), (1, 2, 3))] if delivery > 1 else [],
    )  # fmt: skip


@given(st.lists(st.tuples(COSTS, COSTS), max_size=25))
def test_the_front_is_what_nothing_dominates(points: list[tuple[float, float]]) -> None:
    """By its definition, point against point; equal points count once; cheapest first."""
    kept = front(points)
    for i, (cost, error) in enumerate(points):
        beaten = any(c <= cost and e <= error and (c, e) != (cost, error) for c, e in points)
        assert (points[i] in [points[k] for k in kept]) == (not beaten)
    assert len({points[k] for k in kept}) == len(kept)
    costs = [points[k][0] for k in kept]
    assert costs == sorted(costs)


def test_the_cheapest_that_is_exact_enough_is_advised() -> None:
    """Not the fastest, not the most exact; the line to run is in the sentence."""
    some = [point(seconds=0.1, error=1e-2), point(seconds=0.2, error=9e-5, label="this"),
            point(seconds=0.3, error=1e-9)]  # fmt: skip
    said = advise(some, Wish(want=1e-4))
    assert said.point == 1
    assert "native this is the cheapest" in said.sentence
    assert "`crosstrace render tiny --with native`" in said.sentence
    assert advise(some, Wish(want=1e-4, metric="max")).point == 2
    assert advise(some, Wish(want=1e-4, metric="p999")).point == 2


def test_the_most_exact_within_a_budget_is_advised() -> None:
    """Not the most exact of all."""
    some = [point(seconds=0.1, error=1e-2), point(seconds=0.2, error=1e-5),
            point(seconds=0.3, error=1e-9)]  # fmt: skip
    said = advise(some, Wish(budget_s=0.25))
    assert said.point == 1 and "Within 0.25 s" in said.sentence
    assert "the most exact" in said.sentence


@pytest.mark.parametrize("wish", [Wish(want=1e-12), Wish(budget_s=1e-6)])
def test_a_wish_that_nothing_fulfils_gets_the_nearest_and_says_so(wish: Wish) -> None:
    """No point is advised."""
    said = advise([point(error=1e-3), point(error=1e-5, label="best", seconds=0.05)], wish)
    assert said.point is None
    assert "no measured setting will do; native best comes nearest" in said.sentence


def test_kinds_are_not_weighed_against_each_other() -> None:
    """A sampling error is none from the truth, and a renderer's own rules are not the truth."""
    some = [point(kind="sampling", seconds=0.01, error=1e-9), point(seconds=0.2),
            point("mitsuba", seconds=0.01, error=1e-9, own_rules=True)]  # fmt: skip
    assert advise(some, Wish(want=1e-2)).point == 1
    assert advise(some, Wish(want=1e-2, kind="sampling")).point == 0
    assert advise(some, Wish(want=1e-2, kind="depth")).point is None


def test_what_the_clock_cannot_tell_apart_is_not_advised_by_noise() -> None:
    """Within their spreads, the one that keeps to the specification is taken."""
    some = [point(kind="offset", seconds=0.100, spread=0.01, label="eps=1e-3"),
            point(kind="rounding", seconds=0.105, spread=0.01)]  # fmt: skip
    assert advise(some, Wish(want=1.0)).point == 1
    some[1] |= {"seconds": 0.2, "spread": 1.0}
    assert advise(some, Wish(want=1.0)).point == 0
    some[0]["spread"] = some[1]["spread"] = 0.0
    assert advise(some, Wish(want=1.0)).point == 0


def test_errors_are_over_the_pixels_that_count() -> None:
    """Greatest, RMSE over channels, p99.9 over pixels, and 8-bit colours that are others."""
    value = Value(np.full((2, 2, 3), 0.5), 0.0, np.array([[True, True], [True, False]]))
    image = value.image.copy()
    image[0, 0] = [0.5, 0.53, 0.46]
    image[1, 1] = 77.0
    error = measured(image, 0.0, value)
    assert error.max == pytest.approx(0.04)
    assert error.p999 == error.max
    assert error.rmse == pytest.approx(np.sqrt((0.03**2 + 0.04**2) / 9))
    assert error.wrong_8bit == 1
    nothing = measured(image, 0.0, replace(value, counts=np.zeros((2, 2), np.bool_)))
    assert nothing == Error(None, None, None, None)


def test_errors_below_doubles_digits_are_measured() -> None:
    """The low parts count where the value has some, down to float128's squares."""
    counts = np.ones((1, 1), np.bool_)
    value = Value(np.ones((1, 1, 3)), np.full((1, 1, 3), 1e-200), counts, exact=True)
    error = measured(np.ones((1, 1, 3)), 0.0, value)
    assert error.max == error.p999 == 1e-200
    assert error.rmse == pytest.approx(1e-200)
    assert measured(np.ones((1, 1, 3)), 0.0, replace(value, exact=False)).max == 0.0


def test_an_undefined_error_is_none() -> None:
    """A value that is no number is not an error that JSON could hold."""
    value = Value(np.zeros((1, 2, 3)), 0.0, np.ones((1, 2), np.bool_))
    assert measured(np.full((1, 2, 3), np.nan), 0.0, value).rmse is None
    assert half_widths(-value.image, value.image + 0.5, value.counts).max == 0.25


def test_points_are_of_what_the_scene_calls_for() -> None:
    """No bounces are swept where none are sent, no epsilon without shadows, no lane unasked."""
    kinds = {it.kind for it in plan(scene(), ["native"], [1, 2], range(4))}
    assert {"rounding", "certified", "offset", "depth", "sampling"} <= kinds
    assert "pruning" in kinds
    kinds = {it.kind for it in plan(scene(2), ["native"], [1], range(4))}
    assert kinds == {"rounding", "certified", "offset", "sampling"}
    kinds = {it.kind for it in plan(scene(1), ["native"], [1], range(4))}
    assert kinds == {"rounding", "certified", "sampling"}
    assert {it.renderer for it in plan(scene(), ["povray"], [4], ())} == {"povray"}


def test_a_points_command_says_all_its_settings() -> None:
    """Quoted for a shell, with size and threads."""
    some = Point("povray", "sampling", tuning={"antialias": "0.1"})
    words = "--with povray --tune antialias=0.1 --size 3x4 --threads 1 -o image.npy"
    assert some.command("a b.txt", (3, 4), 1) == f"crosstrace render 'a b.txt' {words}"
    some = Point("native", "depth", "f32", "1e-3", 0.0, 7, Sampling("adaptive", 8))
    words = "--precision f32 --set epsilon=1e-3 --max-depth 7 --sampling adaptive:8 -o image.npy"
    assert some.command("x", None, 0) == f"crosstrace render x --with native {words}"
    assert some.settings == {"precision": "f32", "epsilon": 1e-3, "max_depth": 7,
                             "sampling": "adaptive:8"}  # fmt: skip
    assert Point("native", "depth", max_depth=0).settings["max_depth"] == 0


def test_numbers_of_the_table_are_short() -> None:
    """Each cell keeps within its column, whatever the magnitude."""
    for seconds in (1e-7, 0.00123456, 0.99949, 0.9996, 12.3456, 1234.5):
        assert len(table.time_text(seconds)) <= 8
    rows = [table._row(point(label="x" * 60, seconds=s, rays=r, spread=99.0))
            for s in (1e-5, 0.999, 99.9) for r in (None, 5, 99999, 123456, 10**12)]  # fmt: skip
    widest = [max(map(len, column)) for column in zip(*rows, table.HEADER, strict=True)]
    assert sum(widest) + len(widest) - 1 <= 80


def test_quick_renderings_are_run_more_often_and_slow_ones_less() -> None:
    """Three at least; as often as asked within two seconds; on, for a quarter of one."""
    assert _goes_on(2, 7, 1000.0)
    assert _goes_on(6, 7, 1.9) and not _goes_on(3, 7, 2.1)
    assert _goes_on(7, 7, 0.1) and not _goes_on(7, 7, 0.3)
    assert not _goes_on(60, 7, 0.0)
    assert _goes_on(60, 100, 0.3)


def test_the_spread_is_half_the_distance_of_the_quartiles() -> None:
    """An outlier is kept among the runs and does not move it."""
    assert spread([1.0, 2.0, 3.0, 4.0, 100.0]) == 1.0


def test_the_picture_marks_every_point_and_draws_each_front() -> None:
    """Well-formed; shapes by renderer; fronts are lines, points off them are soft."""
    some = [point(seconds=0.1, error=1e-2, pareto=True), point(seconds=1.0, error=0.0, pareto=True),
            point("povray", seconds=2.0, error=1e-3), point("mitsuba", "sampling", pareto=True),
            point("native", "depth", error=1e-5)]  # fmt: skip
    some[4]["error"] = {"max": None, "rmse": None, "p999": None, "wrong_8bit": None}
    root = ET.fromstring(picture(some, "rmse"))
    marks = [it for it in root.iter(f"{SVG}path") if it.find(f"{SVG}title") is not None]
    assert len(marks) == 4
    assert [it.get("class") for it in marks].count("soft") == 1
    lines = list(root.iter(f"{SVG}polyline"))
    assert [len(it.get("points", "").split()) for it in lines] == [2, 1]
    words = {it.text for it in root.iter(f"{SVG}text")}
    assert {"rounding", "sampling", "0", "seconds an image"} <= words


def test_the_picture_escapes_names_and_stacks_scenes() -> None:
    """A name of a user's is text, not markup; every scene has a plot of its own."""
    nasty = "<script>alert(1)</script>&"
    drawn = picture([point(scene=nasty), point(scene="other")], "max")
    root = ET.fromstring(drawn)
    assert "<script" not in drawn
    titles = [it.text for it in root.iter(f"{SVG}text") if it.get("class") == "title"]
    assert [str(it).split(":")[0] for it in titles] == [nasty, "other"]
    assert "http" not in re.sub(r'xmlns="[^"]*"', "", drawn)
    ET.fromstring(picture([], "rmse"))


@given(st.lists(st.floats(1e-300, 1e10), min_size=1, max_size=9), st.booleans())
def test_an_axis_keeps_the_order_and_its_ends(values: list[float], zero: bool) -> None:
    """Everything lies within the ends, in order, and 0 before all else."""
    axis = Axis.around([*values, *([0.0] if zero else [])], 100.0, 900.0)
    places = [axis(value) for value in sorted(values)]
    assert places == sorted(places)
    assert all(100.0 <= place <= 900.0 for place in places)
    if zero:
        assert 100.0 < axis(0.0) < places[0]
    assert len(decades(axis)) <= 14


@given(st.lists(st.tuples(st.floats(0, 300), st.floats(0, 200)), max_size=30))
def test_labels_cover_neither_each_other_nor_marks(marks: list[tuple[float, float]]) -> None:
    """Where there is no room a label is left out."""
    labels = Labels((0, 0, 300, 200), marks)
    boxes = [(x - 4, y - 4, x + 4, y + 4) for x, y in marks]
    for x, y in marks:
        at = labels.place("label", x, y, 6.0)
        if at is not None:
            box = (at[0], at[1] - 10, at[0] + 30, at[1] + 3)
            assert box[0] >= 0 and box[2] <= 300 and box[1] >= 0 and box[3] <= 200
            for other in boxes:
                apart = (box[2] <= other[0] or other[2] <= box[0]
                         or box[3] <= other[1] or other[3] <= box[1])  # fmt: skip
                assert apart
            boxes.append(box)
