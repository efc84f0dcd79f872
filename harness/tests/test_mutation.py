"""The mutation test's table: its rows, their order, and what a judge gets to see."""

from __future__ import annotations

import json
from collections.abc import Mapping
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from fault_examples import OPTIONS, need, small

from crosstrace.harness import mutation, sources, tasks
from crosstrace.harness.faults import FAULTS, fault, plantings
from crosstrace.harness.jobs import WorkerPool
from crosstrace.harness.sources import Source
from crosstrace.translators.errors import UsageError
from crosstrace.translators.registry import LANES
from crosstrace.translators.renderer import Rendering, RenderOptions

FEW = [fault(name) for name in ("one-bounce-fewer", "gain-1-percent", "eta-plus-one")]


def _sources(*names: str) -> list[Source]:
    return [Source(name, small(name)) for name in names]


def test_rows_come_scene_by_scene_and_are_ready_for_json() -> None:
    """Counts where something changed, null where there is nothing to break, nobody judged."""
    with WorkerPool(1) as pool:
        made = list(mutation.rows(_sources("venn", "espelho2"), pool, faults=FEW, lanes=["native"]))
    records = [json.loads(json.dumps(row.record(), allow_nan=False)) for row in made]
    assert [(it["scene"], it["fault"]) for it in records] == [
        (scene, known.name) for scene in ("venn", "espelho2") for known in FEW
    ]
    assert {tuple(it) for it in records} == {
        ("scene", "lane", "fault", "kind", "changed", "caught", "blamed", "error")
    }
    assert records[0]["changed"] is None
    assert records[1]["changed"] == 4800
    assert records[3]["changed"] > 20
    assert all(it["caught"] is it["blamed"] is it["error"] is None for it in records)


def test_a_judge_sees_the_faulty_lane_among_honest_ones() -> None:
    """It is asked where enough changed and only there; its answer stands in the row."""
    need("mitsuba-f64")
    seen: list[tuple[str, str]] = []

    def judge(source: Source, made: Mapping[str, Rendering], lane: str) -> tuple[bool, bool]:
        if not lane:
            seen.append((source.name, lane))
            return False, False
        for name, it in made.items():
            honest = tasks.render(name, source.scene, OPTIONS)[0].image
            assert np.array_equal(it.image, honest) == (name != lane)
        seen.append((source.name, lane))
        return True, lane == "native"

    with ThreadPoolExecutor(1) as executor:
        table = mutation.rows(
                _sources("venn"),
                executor,
                faults=FEW,
                lanes=["native", "mitsuba-f64"],
                options=OPTIONS,
                judge=judge,
        )  # fmt: skip
        made = list(table)
    assert seen == [("venn", "")] + [("venn", "native")] * 2 + [("venn", "mitsuba-f64")] * 2
    assert [(row.caught, row.blamed) for row in made] == [
        (None, None), (True, True), (True, True), (None, None), (True, False), (True, False),
    ]  # fmt: skip


def test_a_fault_that_changes_too_little_is_not_judged() -> None:
    """Twenty pixels and fewer need not be caught."""

    def judge(source: Source, made: Mapping[str, Rendering], lane: str) -> tuple[bool, bool]:
        assert not lane, "nobody asks"
        return False, False

    with ThreadPoolExecutor(1) as executor:
        (row,) = mutation.rows(
            _sources("polonia"), executor, faults=[fault("radius-times-1.001")],
            lanes=["native"], options=OPTIONS, judge=judge,
        )  # fmt: skip
    assert row.changed is not None
    assert 0 < row.changed <= mutation.CHANGED_ENOUGH
    assert row.caught is None


def test_a_scene_that_is_not_explained_without_a_fault_proves_nothing() -> None:
    """What the judge catches in honest renderings is an error of every row, no fault caught."""

    def judge(source: Source, made: Mapping[str, Rendering], lane: str) -> tuple[bool, bool]:
        assert not lane
        return True, False

    with ThreadPoolExecutor(1) as executor:
        made = list(
            mutation.rows(_sources("venn"), executor, faults=FEW, lanes=["native"], judge=judge)
        )
    assert [row.error for row in made] == ["without a fault: the lanes disagree"] * len(FEW)
    assert all(row.changed is row.caught is row.blamed is None for row in made)


def test_a_lane_that_fails_says_so_in_its_rows_and_takes_no_other_down() -> None:
    """POV-Ray refuses other readings; the native tracer goes on."""
    options = RenderOptions(threads=1, readings={"mix": "convex"})
    with ThreadPoolExecutor(1) as executor:
        table = mutation.rows(
                _sources("venn"),
                executor,
                faults=[fault("gain-1-percent")],
                lanes=["povray", "native"],
                options=options,
        )  # fmt: skip
        made = list(table)
    assert made[0].changed is None
    assert made[0].error is not None
    assert "readings" in made[0].error
    assert (made[1].changed, made[1].error) == (4800, None)


def test_a_lane_that_does_not_exist_is_the_caller_s_mistake() -> None:
    """It is raised, not written into a table."""
    with ThreadPoolExecutor(1) as executor, pytest.raises(UsageError, match="expected a renderer"):
        list(mutation.rows(_sources("venn"), executor, faults=FEW, lanes=["yafaray"]))


@pytest.mark.slow
def test_the_whole_table_shows_every_fault_in_every_lane_somewhere() -> None:
    """On the course scenes and two hard ones, each fault changes more than 20 pixels of one."""
    for lane in LANES:
        need(lane)
    names = (*sources.packaged_names(), "nested-glass")
    with WorkerPool(2, threads=1) as pool:
        made = list(mutation.rows(sources.find(names, size=(60, 80)), pool))
    assert len(made) == len(names) * sum(len(plantings(lane)) for lane in LANES)
    assert [row for row in made if row.error] == []
    shown = {(row.lane, row.fault) for row in made if (row.changed or 0) > mutation.CHANGED_ENOUGH}
    assert shown == {(lane, known.name) for known in FAULTS for lane in known.lanes}
