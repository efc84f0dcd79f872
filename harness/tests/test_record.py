"""The record of a run: its schema, what it never holds, and what it says of a scene."""

from __future__ import annotations

import json
import math
import tempfile
from pathlib import Path
from typing import Any

import jsonschema
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from crosstrace.harness import record
from crosstrace.harness.session import RunOptions, run
from crosstrace.harness.sources import Source
from crosstrace.translators.effects import EFFECTS
from crosstrace.translators.errors import RendererError, RendererMissingError, UsageError
from crosstrace.translators.ledger import Entry
from crosstrace.translators.scene import Scene, plane, sphere


def _scene(**more: Any) -> Scene:
    return Scene.build(
        v_res=11, h_res=11, pixel_size=1.0, screen_distance=10.0,
        eye=[0, 0, 10], target=[0, 0, 0], up=[0, 1, 0], background=[0, 0, 0],
        **{"delivery": 3, "max_depth": 1, **more},
    )  # fmt: skip


def _check(report: dict[str, Any]) -> None:
    jsonschema.Draft202012Validator(record.schema()).validate(report)


def test_the_schema_is_a_schema() -> None:
    """By the rules of JSON Schema itself."""
    jsonschema.Draft202012Validator.check_schema(record.schema())


@pytest.mark.parametrize(
    "lanes",
    [
        ("fake_lanes:Gradient", "fake_lanes:Brighter"),
        ("fake_lanes:Gradient",),
        ("fake_lanes:Gradient", "fake_lanes:Absent", "fake_lanes:Refusing", "fake_lanes:Undefined"),
        ("native", "fake_lanes:Gradient"),
    ],
)
def test_the_record_of_a_run_follows_the_schema(lanes: tuple[str, ...], tmp_path: Path) -> None:
    """Whether renderers work, are missing, refuse or return what is not a number."""
    scene = _scene(objects=[sphere([9, 9, 9], [0, 0, 0], 1.0)])
    tiny = _scene(lights=[([255, 255, 255], [0, 9, 0])]).resized(1, 1)
    report = run([scene, tiny], tmp_path / "out", RunOptions(lanes, jobs=2, timeout_s=60))
    _check(report)
    _check(record.loads(tmp_path / "out/report.json"))
    assert len(report["scenes"][0]["pairs"]) == len(lanes) * (len(lanes) - 1) // 2
    assert all(pair["ssim"] is None for pair in report["scenes"][1]["pairs"])


def test_the_record_holds_no_place_of_the_machine(tmp_path: Path) -> None:
    """A report can be handed on: neither the directory nor the home nor scratch files are in it."""
    report = run([_scene()], tmp_path / "out", RunOptions(("fake_lanes:Crashing",)))
    text = (tmp_path / "out/report.json").read_text(encoding="utf-8")
    assert str(tmp_path) not in text
    assert str(Path.home()) not in text.replace("\\/", "/")
    assert tempfile.gettempdir() + "/" not in text
    assert report["scenes"][0]["renderers"][0]["message"]


def test_places_in_messages_are_shortened() -> None:
    """What a renderer prints is kept, without the names of scratch files and of the user."""
    home = str(Path.home())
    text = f"cannot read /var/x/crosstrace-a1b2c3d4/worker-1.log or {home}/scenes/a.txt"
    told = json.loads(record.dumps({"message": text}))["message"]
    assert told == "cannot read (scratch)/worker-1.log or ~/scenes/a.txt"
    assert json.loads(record.dumps({"m": f"{home}less"}))["m"] == f"{home}less"


def test_effects_called_for_and_left_out_are_all_effects() -> None:
    """In the order of the specification, each in one of the two lists."""
    glass = sphere([255, 255, 255], [0, 0, 0], 1.0, ka=0, kd=0, ks=0, kr=0.5, kt=0.5, n=1.5)
    source = Source("glass", _scene(objects=[glass]))
    entry = record.scene(source, [], [], record.not_judged("no image"), {})
    assert entry["effects"] == ["reflection", "refraction", "total_reflection"]
    assert sorted(entry["effects"] + entry["left_out"]) == sorted(EFFECTS)


def test_an_image_missing_makes_a_scene_incomplete_and_never_hides_a_fault() -> None:
    """What is found of the images that are there is kept, whatever is not there."""
    source = Source("a", _scene(objects=[plane([1, 1, 1], [0, 0, 0], [0, 1, 0])]))
    x = {"name": "x", "status": "ok"}
    missing = {"name": "y", **record.failed(RendererError("no"))}
    fine = {"message": "", "verdict": "explained", "blame": [], "lanes": {}, "images": {}}
    wrong = {**fine, "verdict": "disagree", "blame": ["x"]}
    pair = record.not_compared("no image of y")
    cases = (
        ([x], [], fine, "explained"), ([x, missing], [], fine, "incomplete"),
        ([x], [pair], fine, "incomplete"), ([x, missing], [pair], wrong, "disagree"),
        ([x], [], record.not_judged("it took too long"), "incomplete"),
    )  # fmt: skip
    for lanes, pairs, judged, verdict in cases:
        entry = record.scene(source, lanes, pairs, judged, {})
        assert entry["verdict"] == verdict
        assert set(entry["renderers"][0]["classes"].values()) == {None}


def test_a_failure_keeps_its_kind_and_its_words() -> None:
    """A foreign exception is told with its type."""
    missing = record.failed(RendererMissingError("no LLVM", "apt-get install libllvm19"))
    assert missing["status"] == "missing"
    assert missing["message"] == "no LLVM (install it with: apt-get install libllvm19)"
    foreign = record.failed(ZeroDivisionError("by zero"))
    assert (foreign["status"], foreign["message"]) == ("failed", "ZeroDivisionError: by zero")


def test_a_declaration_about_many_objects_lists_the_first_and_counts_all() -> None:
    """A scene of a million objects must not make a record of a million numbers."""
    entry = Entry("geometry", "far away", "approximated", 1e-3, tuple(range(10_000)))
    (told,) = record.ledger([entry])
    assert told["n_objects"] == 10_000
    assert told["objects"] == list(range(len(told["objects"])))
    assert 0 < len(told["objects"]) < 1000


_SCALARS = st.none() | st.booleans() | st.integers() | st.floats() | st.text()
_VALUES = st.recursive(
    _SCALARS, lambda inner: st.lists(inner) | st.dictionaries(st.text(), inner), max_leaves=20
)


@given(st.dictionaries(st.text(), _VALUES))
def test_any_record_becomes_json_that_every_reader_takes(value: dict[str, Any]) -> None:
    """Strictly JSON: a constant like NaN is not, and numbers come back to the last bit."""

    def refuse(constant: str) -> None:
        raise AssertionError(constant)

    read = json.loads(record.dumps(value), parse_constant=refuse)
    assert record.dumps(read) == record.dumps(value)
    for key, item in value.items():
        if isinstance(item, float):
            assert read[key] == (item if math.isfinite(item) else None)


def test_numbers_of_numpy_become_plain_ones() -> None:
    """Also those that are not finite."""
    value = {"a": np.float64(0.1), "b": np.int32(3), "c": np.float32("nan"), "d": np.bool_(True)}
    assert json.loads(record.dumps(value)) == {"a": 0.1, "b": 3, "c": None, "d": True}


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("{", "expected JSON"),
        ("[1]", "expected a record of schema crosstrace-report/1, found 'list'"),
        ("{}", "found None"),
        ('{"schema": "crosstrace-report/9"}', "found 'crosstrace-report/9'"),
    ],
)
def test_another_file_is_refused_as_a_record(text: str, says: str, tmp_path: Path) -> None:
    """The message says what was expected and what was found."""
    path = tmp_path / "report.json"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(UsageError, match="expected") as caught:
        record.loads(path)
    assert says in str(caught.value)
    with pytest.raises(UsageError, match="cannot be read"):
        record.loads(tmp_path / "none.json")
