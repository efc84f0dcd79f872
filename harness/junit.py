"""A check or a run as JUnit XML: a suite a scene, a case a renderer, one for the verdict.

The dialect is the common part of what Jenkins, GitLab and GitHub's reporters read: a change that
fails is a `failure`, a renderer without an image an `error`, and what is only noted stands in
`system-out`. A character that XML 1.0 cannot hold becomes a question mark.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from typing import Any
from xml.etree.ElementTree import Element, SubElement, indent, tostring

from crosstrace.harness.outcome import outcome, sentence

_NOT_XML = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")


def document(checked: Mapping[str, Any], name: str = "crosstrace check") -> bytes:
    """Return the XML of a check's record (`regression.check`)."""
    root = Element("testsuites", name=name)
    for scene in checked["scenes"]:
        suite = SubElement(root, "testsuite", name=_text(scene["name"]),
                           timestamp=checked["created"].removesuffix("+00:00"))  # fmt: skip
        _properties(suite, checked, scene)
        named = {change["lane"] for change in scene["changes"]}
        lanes = [lane["name"] for lane in scene["renderers"]]
        _case(suite, scene, "verdict", 0.0, [c for c in scene["changes"] if not c["lane"]])
        for lane in scene["renderers"]:
            mine = [c for c in scene["changes"] if c["lane"] == lane["name"]]
            _case(suite, scene, lane["name"], lane["seconds"], mine)
        for lane_name in sorted(named - {*lanes, ""}):
            mine = [c for c in scene["changes"] if c["lane"] == lane_name]
            _case(suite, scene, lane_name, 0.0, mine)
        _count(suite)
    _count(root)
    indent(root)
    written: bytes = tostring(root, encoding="utf-8", xml_declaration=True)
    return written + b"\n"


def of_run(report: Mapping[str, Any]) -> bytes:
    """Return the XML of a run's record (`record.report`): what departs from its index fails."""
    scenes = [
        {
            "name": scene["name"],
            "verdict": scene["verdict"],
            "sha256": scene["sha256"],
            "reason": None,
            "sentence": sentence(scene),
            "changes": list(_found(scene)),
            "absent": list(_absent(scene)),
            "renderers": [
                {"name": lane["name"], "seconds": sum(s or 0.0 for s in lane["seconds"].values())}
                for lane in scene["renderers"]
            ],
        }
        for scene in report["scenes"]
    ]
    run = {"created": report["run"]["created"], "environment": report["environment"]}
    return document({**run, "scenes": scenes}, "crosstrace run")


def _found(scene: Mapping[str, Any]) -> Iterator[dict[str, Any]]:
    """Say of the verdict and of each lane what is not plainly equal, and whether it fails."""
    departs = outcome(scene) == "departs"
    yield {"text": f"{scene['verdict']}. {sentence(scene)}", "fails": departs, "lane": ""}
    for lane in scene["renderers"]:
        some = {name: count for name, count in lane["classes"].items() if count and name != "equal"}
        if some:
            said = ", ".join(f"{count:,} {name}" for name, count in some.items())
            fails = departs and lane["name"] in scene["blame"]
            yield {"text": f"{said} pixels", "fails": fails, "lane": lane["name"]}


def _absent(scene: Mapping[str, Any]) -> Iterator[dict[str, str]]:
    for lane in scene["renderers"]:
        if lane["status"] != "ok":
            yield {"lane": lane["name"], "status": lane["status"], "message": lane["message"]}
        elif lane["classes"]["equal"] is None:
            why = scene["judgement"]["message"]
            yield {"lane": lane["name"], "status": "not judged", "message": why}


def _properties(suite: Element, checked: Mapping[str, Any], scene: Mapping[str, Any]) -> None:
    environment = checked["environment"]
    facts = {
        "verdict": scene["verdict"], "sha256": scene["sha256"], "golden": scene["reason"],
        "crosstrace": environment["crosstrace"], "cpu": environment["cpu"],
    }  # fmt: skip
    listed = SubElement(suite, "properties")
    for name, value in facts.items():
        SubElement(listed, "property", name=name, value=_text(str(value or "")))


def _case(
    suite: Element, scene: Mapping[str, Any], name: str, seconds: float,
    changes: Sequence[Mapping[str, Any]],
) -> Element:  # fmt: skip
    case = SubElement(suite, "testcase", classname=_text(f"crosstrace.{scene['name']}"),
                      name=_text(name), time=f"{seconds:.3f}")  # fmt: skip
    failures = [change["text"] for change in changes if change["fails"]]
    if failures:
        failure = SubElement(case, "failure", message=_text(failures[0]), type="changed")
        failure.text = _text("\n".join([*failures, scene["sentence"]]))
    for lane in scene["absent"]:
        if lane["lane"] == name:
            SubElement(case, "error", message=_text(lane["message"]), type=lane["status"])
    notes = [change["text"] for change in changes if not change["fails"]]
    if notes:
        SubElement(case, "system-out").text = _text("\n".join(notes))
    return case


def _count(element: Element) -> None:
    cases = list(element.iter("testcase"))
    counted = {
        "tests": len(cases),
        "failures": sum(case.find("failure") is not None for case in cases),
        "errors": sum(case.find("error") is not None for case in cases),
        "skipped": 0,
    }
    for name, count in counted.items():
        element.set(name, str(count))
    element.set("time", f"{sum(float(case.get('time', '0')) for case in cases):.3f}")


def _text(text: str) -> str:
    return _NOT_XML.sub("?", text)
