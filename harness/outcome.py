"""What a scene's verdict means for the exit status, and in words: from the record alone."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any, Literal

Outcome = Literal["fine", "departs", "incomplete"]

GOOD = ("agree", "explained")

OK, DISAGREES, RENDERER_FAILED = 0, 1, 3

#: Of a check, or of the proof that checks catch faults: its status in a word.
EXIT_STATUS = {"pass": OK, "fail": DISAGREES, "incomplete": RENDERER_FAILED}


def outcome(scene: Mapping[str, Any]) -> Outcome:
    """Say whether a scene came out as it should: well, or exactly as its index expects.

    An expectation holds where every lane that it blames is in the run.
    """
    if scene["verdict"] == "incomplete":
        return "incomplete"
    expected = applying(scene)
    if expected is None:
        return "fine" if scene["verdict"] in GOOD else "departs"
    same = scene["verdict"] == expected["verdict"]
    return "fine" if same and set(scene["blame"]) == set(expected["blame"]) else "departs"


def applying(scene: Mapping[str, Any]) -> Mapping[str, Any] | None:
    """Return what the scene's index expects of these lanes; None: agreement."""
    expected: Mapping[str, Any] | None = scene["expected"]
    lanes = {lane["name"] for lane in scene["renderers"]}
    return expected if expected and set(expected["blame"]) <= lanes else None


def exit_status(report: Mapping[str, Any]) -> int:
    """Return 1 where a scene departs from what it should be, else 3 where one is incomplete."""
    found = {outcome(scene) for scene in report["scenes"]}
    if "departs" in found:
        return DISAGREES
    return RENDERER_FAILED if "incomplete" in found else OK


def sentence(scene: Mapping[str, Any]) -> str:
    """Say in words how a scene came out: who is right, who is wrong, and where."""
    parts = [_headline(scene), *_exceptions(scene)]
    expected = applying(scene)
    if expected is not None:
        as_expected = "As expected" if outcome(scene) == "fine" else "The index expects"
        parts.append(f"{as_expected}: {expected['verdict']}; {expected['cause']}")
    if message := scene["judgement"]["message"]:
        parts.append(f"Not judged: {message}")
    return ". ".join(part.rstrip(".") for part in parts) + "."


def _headline(scene: Mapping[str, Any]) -> str:
    lanes = [lane for lane in scene["renderers"] if lane["classes"]["equal"] is not None]
    blame = scene["blame"]
    if scene["verdict"] == "reference-broken":
        against = scene["judgement"]["agreed_against_reference"]
        outside = scene["judgement"]["truth"]["float128_outside"]
        why = "leaves its own enclosure"
        if outside:
            why = f"float128 leaves its own enclosure in {outside:,} pixels"
        elif against:
            why = f"independent renderers agree with each other against it in {against:,} pixels"
        return f"The reference {', '.join(blame)} is not to be trusted here: {why}"
    right = [lane["name"] for lane in lanes if lane["name"] not in blame]
    if not right:
        return "No renderer agrees with the truth" if lanes else "There is no image to judge"
    everywhere = all(lane["classes"]["undecidable"] == 0 for lane in lanes)
    where = "everywhere" if everywhere else "everywhere that the scene decides"
    verb = "agrees" if len(right) == 1 else "agree"
    return f"{_listed(right)} {verb} with the truth {where}"


def _exceptions(scene: Mapping[str, Any]) -> Iterator[str]:
    """Say of each lane what is not plainly equal, and where it is wrong."""
    words = {
        "rounding": "within rounding",
        "undecidable": "undecidable",
        "model": "by its declared habits",
        "suspect": "suspect",
    }
    for lane in scene["renderers"]:
        classes = lane["classes"]
        said = [f"{classes[key]:,} {text}" for key, text in words.items() if classes[key]]
        if classes["wrong"]:
            said.insert(0, f"wrong on {classes['wrong']:,} pixels ({_where(lane)})")
        elif lane["name"] in scene["blame"]:
            said.append(f"mostly {_where(lane)}")
        for met in lane["declared"]:
            said.append(
                f"{met['pixels']:,} of {met['looked_at']:,} of these meet what it declares but "
                f"nothing reproduces ({met['situation']})"
            )
        if said:
            yield f"{lane['name']}: {', '.join(said)}"


def _where(lane: Mapping[str, Any]) -> str:
    """Describe the largest region, and how many others there are."""
    if not lane["regions"]:
        return "nowhere in particular"
    first, rest = lane["regions"][0], lane["n_regions"] - 1
    more = f" and {rest:,} other places" if rest > 1 else " and one other place" if rest else ""
    kind = first["kind"]
    article = "a " if kind in ("speckle", "blob") or kind.startswith(("gain", "shift")) else ""
    return f"{article}{kind} on {first['where']}{more}"


def _listed(names: list[str]) -> str:
    return names[0] if len(names) == 1 else f"{', '.join(names[:-1])} and {names[-1]}"
