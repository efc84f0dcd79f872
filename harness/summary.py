"""A run's record as two small tables: every image against the reference, and each lane in all."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from crosstrace.harness.lanes import REFERENCE
from crosstrace.harness.outcome import outcome, sentence

Table = tuple[tuple[str, ...], list[tuple[str, ...]], tuple[str, ...]]

_NUMBERS = ("max diff", "> 1/255", "SSIM", "seconds")

#: Scene names are cut to this, so that a line keeps within 80 columns.
_LONGEST_NAME = 20


def by_scene(report: Mapping[str, Any]) -> Table:
    """Return header, rows and number columns: each lane of each scene against the reference.

    The reference is native, or the first lane of a run without it.
    """
    rows: list[tuple[str, ...]] = []
    for scene in report["scenes"]:
        name = scene["name"]
        name = name if len(name) <= _LONGEST_NAME else name[: _LONGEST_NAME - 1] + "…"
        pairs = _against_reference(scene)
        for i, lane in enumerate(scene["renderers"]):
            cells = _cells([pairs[lane["name"]]] if lane["name"] in pairs else [])
            first = name if i == 0 else ""
            rows.append((first, lane["name"], lane["status"], *cells, _time(_seconds(lane))))
    return ("scene", "renderer", "status", *_NUMBERS), rows, _NUMBERS


def by_lane(report: Mapping[str, Any]) -> Table:
    """Return the same of each lane over all scenes: worst difference and SSIM, else sums."""
    rows: list[tuple[str, ...]] = []
    n_scenes = len(report["scenes"])
    for i, name in enumerate(_lanes(report)):
        lanes = [scene["renderers"][i] for scene in report["scenes"]]
        pairs = [_against_reference(scene) for scene in report["scenes"]]
        cells = _cells([found[name] for found in pairs if name in found])
        times = [taken for lane in lanes if (taken := _seconds(lane)) is not None]
        n_ok = sum(lane["status"] == "ok" for lane in lanes)
        taken = sum(times) if times else None
        rows.append((name, f"{n_ok} of {n_scenes}", *cells, _time(taken)))
    return ("all scenes", "images", *_NUMBERS), rows, _NUMBERS


def verdicts(report: Mapping[str, Any], only_departing: bool = False) -> Iterator[str]:
    """Say of each scene how it came out, in words; those that agree share a line.

    `only_departing`: of none that came out as it should.
    """
    agreeing = [scene["name"] for scene in report["scenes"] if scene["verdict"] == "agree"]
    if agreeing and not only_departing:
        yield f"agree: {', '.join(agreeing)}"
    for scene in report["scenes"]:
        if only_departing and outcome(scene) == "fine":
            continue
        if scene["verdict"] != "agree":
            yield f"{scene['name']}: {scene['verdict']}. {sentence(scene)}"


def failures(report: Mapping[str, Any]) -> Iterator[str]:
    """Say each reason once why a lane gave no image, with the scenes it concerns."""
    reasons: dict[tuple[str, str, str], list[str]] = {}
    for scene in report["scenes"]:
        for lane in scene["renderers"]:
            if lane["status"] != "ok":
                reason = (lane["name"], lane["status"], lane["message"])
                reasons.setdefault(reason, []).append(scene["name"])
    for (lane_name, status, message), scenes in reasons.items():
        everywhere = len(scenes) == len(report["scenes"])
        where = "" if everywhere else f" ({', '.join(scenes)})"
        yield f"{lane_name} {status}{where}: {message}"


def _lanes(report: Mapping[str, Any]) -> list[str]:
    return [lane["name"] for lane in report["scenes"][0]["renderers"]]


def _against_reference(scene: Mapping[str, Any]) -> dict[str, Mapping[str, Any]]:
    """Return lane → its pair with the reference, where the two were compared."""
    names = [lane["name"] for lane in scene["renderers"]]
    reference = REFERENCE if REFERENCE in names else names[0]
    found = {}
    for pair in scene["pairs"]:
        if reference in (pair["a"], pair["b"]) and pair["pixels"] is not None:
            found[pair["b"] if pair["a"] == reference else pair["a"]] = pair
    return found


def _cells(pairs: list[Mapping[str, Any]]) -> tuple[str, str, str]:
    """Return greatest difference, sum of pixels beyond 1/255 and least SSIM of some pairs."""
    if not pairs:
        return "", "", ""
    sizes = [pair["max"] for pair in pairs]
    worst = "not finite" if None in sizes else f"{max(sizes):.2g}"
    similar = [pair["ssim"] for pair in pairs if pair["ssim"] is not None]
    beyond = f"{sum(pair['over_1_255'] for pair in pairs):,}"
    return worst, beyond, f"{min(similar):.6f}" if similar else "-"


def _seconds(lane: Mapping[str, Any]) -> float | None:
    stages = [value for value in lane["seconds"].values() if value is not None]
    return sum(stages) if stages else None


def _time(seconds: float | None) -> str:
    return "" if seconds is None else f"{seconds:.2f}"
