"""A check and a run as JUnit XML: what counts as a failure and what as an error."""

from __future__ import annotations

from pathlib import Path
from typing import Any
from xml.etree import ElementTree

from small_runs import sky

from crosstrace.harness import junit
from crosstrace.harness.session import RunOptions, run


def change(text: str, fails: bool, lane: str = "") -> dict[str, Any]:
    return {"what": "classes", "text": text, "fails": fails, "lane": lane, "pixels": ()}


def checked(**scene: Any) -> dict[str, Any]:
    lanes = [{"name": name, "status": "ok", "seconds": 0.25} for name in ("a", "b")]
    plain = {"name": "sky", "verdict": "agree", "sha256": "0", "reason": None, "sentence": "So.",
             "changes": [], "absent": [], "renderers": lanes}  # fmt: skip
    return {"created": "2026-01-02T03:04:05+00:00", "scenes": [{**plain, **scene}],
            "environment": {"crosstrace": "1", "cpu": "a"}}  # fmt: skip


def cases(record: dict[str, Any]) -> dict[str, Any]:
    return {case.get("name", ""): case for case in parsed(record).iter("testcase")}


def parsed(record: dict[str, Any]) -> ElementTree.Element:
    return ElementTree.fromstring(junit.document(record))


def test_a_scene_is_a_suite_with_a_case_for_the_verdict_and_each_lane() -> None:
    """Counts and times are sums; the dates are those of the run."""
    root = parsed(checked())
    (suite,) = root
    assert (suite.get("name"), suite.get("timestamp")) == ("sky", "2026-01-02T03:04:05")
    for element in (root, suite):
        counts = [element.get(key) for key in ("tests", "failures", "errors", "skipped", "time")]
        assert counts == ["3", "0", "0", "0", "0.500"]
    assert list(cases(checked())) == ["verdict", "a", "b"]


def test_a_failing_change_is_a_failure_of_its_lane() -> None:
    """The first one is its message, all stand in its text with the verdict in words."""
    changes = [change("one", True, "b"), change("two", True, "b"), change("noted", False, "b")]
    found = cases(checked(changes=changes))
    failure = found["b"].find("failure")
    assert failure is not None and failure.get("message") == "one"
    assert failure.text == "one\ntwo\nSo."
    assert found["b"].findtext("system-out") == "noted"
    assert found["a"].find("failure") is None and found["verdict"].find("failure") is None


def test_an_absent_lane_is_an_error_and_never_skipped() -> None:
    """A missing renderer is no pass."""
    absent = [{"lane": "b", "status": "missing", "message": "no such program"}]
    record = checked(absent=absent)
    error = cases(record)["b"].find("error")
    assert error is not None and error.get("message") == "no such program"
    assert (parsed(record).get("errors"), parsed(record).get("skipped")) == ("1", "0")


def test_a_change_of_the_reference_has_a_case_where_the_lane_was_not_asked_for() -> None:
    """Nothing that fails is lost."""
    found = cases(checked(changes=[change("one", True, "native")]))
    assert found["native"].find("failure") is not None


def test_what_xml_cannot_hold_is_replaced() -> None:
    """Names of scenes and messages of programs may hold anything."""
    text = 'a\x00b\x1b[31m<&"\ud800é\U0001f600'
    record = checked(changes=[change(text, True)], name=text)
    failure = cases(record)["verdict"].find("failure")
    assert failure is not None and failure.get("message") == 'a?b?[31m<&"?é\U0001f600'


def test_a_run_fails_where_a_scene_departs_and_in_the_lanes_to_blame(tmp_path: Path) -> None:
    """An absent renderer is an error, and what is only not equal a note."""
    plain, ramp, absent = (f"fake_lanes:{name}" for name in ("Plain", "Gradient", "Absent"))
    report = run([sky()], tmp_path / "out", RunOptions((plain, ramp, absent), jobs=2, timeout_s=60))
    root = ElementTree.fromstring(junit.of_run(report))
    assert root.get("name") == "crosstrace run"
    found = {case.get("name", ""): case for case in root.iter("testcase")}
    assert list(found) == ["verdict", plain, ramp, absent]
    for name, fails in (("verdict", True), (plain, False), (ramp, True)):
        assert (found[name].find("failure") is not None) == fails
    assert found[absent].find("error") is not None
    assert (root.get("failures"), root.get("errors")) == ("2", "1")
    report["scenes"][0]["expected"] = {"verdict": "disagree", "blame": [ramp], "cause": "a ramp"}
    calm = ElementTree.fromstring(junit.of_run(report))
    assert calm.get("failures") == "0"
    assert "192 wrong" in "".join(calm.itertext())
