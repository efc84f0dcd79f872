"""The suite proves itself: planted faults are caught, and blamed on the lane that has them."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest
from command_line import call, scene_file
from fault_examples import SIZE, need

from crosstrace.harness import fault_proof, mutation, sources
from crosstrace.harness.faults import fault, plantings
from crosstrace.harness.session import RunOptions
from crosstrace.harness.sources import Source
from crosstrace.translators.registry import LANES
from crosstrace.translators.renderer import Rendering

#: Among them what only float32 could hide: in these scenes it has shadow rays and refracted rays
#: meet their own surface, as if a light or a bounce were left out.
FEW = [
    fault(name)
    for name in ("one-light-missing", "one-bounce-fewer", "eta-plus-one", "gain-1-percent")
]


def escapes(record: Mapping[str, Any]) -> list[Mapping[str, Any]]:
    return [row for row in record["rows"] if fault_proof.state(row) in ("escaped", "failed")]


def test_a_handful_of_faults_is_caught_and_blamed_in_every_lane() -> None:
    """In two scenes that could hide them; the record counts, and is JSON as it stands."""
    for lane in LANES:
        need(lane)
    found = sources.find(["eclipse", "bolha2"])
    made = fault_proof.prove(found, RunOptions(size=(30, 40)), faults=FEW)
    assert not escapes(made)
    assert (made["status"], fault_proof.exit_status(made)) == ("pass", 0)
    assert len(made["rows"]) == 2 * len(FEW) * len(LANES)
    for scene in made["scenes"]:
        assert scene["judged"] == scene["caught"] == scene["blamed"] >= 8
        assert scene["size"] == [30, 40]
    assert json.loads(json.dumps(made, allow_nan=False)) == made


@pytest.mark.slow
@pytest.mark.timeout(7200)
@pytest.mark.parametrize("name", sources.packaged_names())
def test_every_fault_is_caught_and_blamed_on_every_course_scene(name: str) -> None:
    """The whole catalogue in every lane, at 60 x 80."""
    for lane in LANES:
        need(lane)
    made = fault_proof.prove(sources.find([name]), RunOptions(size=SIZE))
    assert not escapes(made)
    assert len(made["rows"]) == sum(len(plantings(lane)) for lane in LANES)
    assert made["scenes"][0]["judged"] >= 20


def judge_of(answer: tuple[bool, bool]) -> type:
    class Judge:
        def __init__(self, threads: int) -> None:
            pass

        def __call__(
            self, source: Source, made: Mapping[str, Rendering], lane: str
        ) -> tuple[bool, bool]:
            return answer if lane else (False, False)

    return Judge


@pytest.mark.parametrize("answer", [(False, False), (True, False)])
def test_one_escape_fails_the_proof(
    answer: tuple[bool, bool], monkeypatch: pytest.MonkeyPatch
) -> None:
    """A fault that nobody catches, or that is blamed on another lane, ends with 1."""
    monkeypatch.setattr(mutation, "Court", judge_of(answer))
    how = RunOptions(lanes=("native",), size=(12, 16))
    made = fault_proof.prove(sources.find(["venn"]), how, faults=[fault("gain-1-percent")])
    assert len(escapes(made)) == 1
    assert (made["status"], fault_proof.exit_status(made)) == ("fail", 1)


def test_where_nothing_is_judged_nothing_is_proven() -> None:
    """A fault that the scene does not have is no proof: the status is 3."""
    how = RunOptions(lanes=("native",), size=(12, 16))
    made = fault_proof.prove(sources.find(["venn"]), how, faults=[fault("one-bounce-fewer")])
    assert (made["status"], fault_proof.exit_status(made)) == ("incomplete", 3)


def test_large_scenes_are_proven_at_sixty_rows() -> None:
    """Unless a size is given; smaller scenes keep theirs."""
    how = RunOptions(lanes=("native",))
    made = fault_proof.prove(sources.find(["venn"]), how, faults=[fault("image-mirrored")])
    assert made["scenes"][0]["size"] == [60, 80]


def test_the_command_prints_the_table_and_keeps_it(tmp_path: Path) -> None:
    """A row a fault, a column a scene, how many lanes caught it; the record beside it."""
    scene_file(tmp_path)
    words = ("check", "tiny.txt", "--faults", "--renderers", "native", "-o", "out")
    done = call(*words, cwd=tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr
    lines = [line.split() for line in done.stdout.splitlines()]
    assert lines[:2] == [["a", "tiny"], ["fault", "a"]]
    assert ["one-bounce-fewer", "1"] in lines
    assert ["glass-filters-light"] in lines
    assert max(map(len, done.stdout.splitlines())) <= 80
    record = json.loads((tmp_path / "out/mutation.json").read_text())
    assert record["status"] == "pass"
    assert {row["fault"] for row in record["rows"]} == {it.name for it in plantings("native")}


@pytest.mark.parametrize("words", [("--junit", "x.xml"), ("--reference", "."), ("-o", "tiny.txt")])
def test_what_does_not_go_with_faults_is_wrong_usage(tmp_path: Path, words: tuple[str]) -> None:
    """It ends with 2, before anything is rendered."""
    scene_file(tmp_path)
    done = call("check", "tiny.txt", "--faults", *words, cwd=tmp_path)
    assert done.returncode == 2
    assert "Traceback" not in done.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["tiny.txt"]
