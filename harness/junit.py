"""A check as JUnit XML: a suite a scene, a case a renderer, one for the reference, one in all.

The dialect is the common part of what Jenkins, GitLab and GitHub's reporters read: a change that
fails is a `failure`, a renderer without an image an `error`, and what is only noted stands in
`system-out`. A character that XML 1.0 cannot hold becomes a question mark.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from typing import Any
from xml.etree.ElementTree import Element, SubElement, indent, tostring

_NOT_XML = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")


def document(checked: Mapping[str, Any]) -> bytes:
    """Return the XML of a check's record (`regression.check`)."""
    root = Element("testsuites", name="crosstrace check")
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
