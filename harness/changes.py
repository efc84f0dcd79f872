"""What changed between a golden and today's result of a scene, and which of it fails a check.

| what | fails | is only noted |
|---|---|---|
| scene | other numbers, so another scene: nothing else is compared | |
| verdict | another word or other lanes to blame | |
| lane | gave an image and now declares the scene unsupported, or has no golden | another version |
| now `wrong` | any pixel; on another processor growth beyond 2 √(then + now) or from 0 | rest |
| `equal`, now `suspect` | as for `wrong`, with the count of suspect pixels | the rest |
| explained, now `suspect` | never by itself: the verdict caps suspect pixels | any |
| count of `rounding`, `undecidable`, `model` | moved beyond 4 + 4 √(then + now) | moved less |
| native image and ray trees | more than rounding may do (`fingerprint.py`) | the rest |
| metrics of a pair | never: they inform | another count beyond 1/255 or 1e-4 |

Counts in which rounding falls one way or the other behave like Poisson counts: two arithmetics that
are equally honest differ by about √(then + now) there. Processors differ so because float32
lanes are compiled for their own instructions: Mitsuba's for AVX2 and AVX-512 have other
approximate square roots, and from one to the other 2 pixels of `canto` and 14 of a known defect of
833 go over. On one processor all is the same to the last bit.
A lane without an image is `incomplete`; it fails nothing and passes nothing.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crosstrace.harness.classes import NAMES, Class
from crosstrace.harness.fingerprint import NAMED, Difference
from crosstrace.harness.goldens import Classes, Golden
from crosstrace.harness.lanes import REFERENCE

#: Classes by which a value that is not equal is explained.
EXPLAINED = (Class.ROUNDING, Class.UNDECIDABLE, Class.MODEL)

#: What tells processors apart whose float32 may differ.
PROCESSOR = ("machine", "cpu", "cpu_features")

Place = tuple[int, int]


@dataclass(frozen=True)
class Change:
    """One change; `lane` is empty for the scene as a whole, `pixels` are the first few."""

    what: str
    text: str
    fails: bool
    lane: str = ""
    pixels: tuple[Place, ...] = ()


def find(
    golden: Golden,
    scene: Mapping[str, Any],
    classes: Classes,
    differences: Sequence[Difference],
    environment: Mapping[str, Any],
) -> list[Change]:
    """Compare a scene's record and classes with its golden; failures come first."""
    made_on = golden.about["environment"]
    same_processor = all(made_on.get(key) == environment[key] for key in PROCESSOR)
    if golden.about["scene"]["sha256"] != scene["sha256"]:
        return [_other_scene(golden, scene)]
    found = [*_of_verdict(golden, scene)]
    for lane in scene["renderers"]:
        then = golden.lanes.get(lane["name"])
        if then is None:
            text = "has no golden: accept one with `crosstrace bless`"
            found.append(Change("lane", text, True, lane["name"]))
            continue
        found += _of_lane(then, lane)
        if lane["name"] in classes and lane["name"] in golden.classes:
            then_and_now = golden.classes[lane["name"]], classes[lane["name"]]
            found += of_classes(lane["name"], *then_and_now, same_processor)
    found += [Change("reference", d.text, d.fails, REFERENCE, d.pixels) for d in differences]
    found += _of_pairs(golden, scene)
    if found and not same_processor:
        text = f"another processor: {made_on.get('cpu')} -> {environment['cpu']}"
        found.append(Change("environment", text, False))
    return sorted(found, key=lambda change: not change.fails)


def _other_scene(golden: Golden, scene: Mapping[str, Any]) -> Change:
    then = golden.about["scene"]
    sizes = f"{then['v_res']}x{then['h_res']}", f"{scene['v_res']}x{scene['h_res']}"
    how = f"at {sizes[0]} instead of {sizes[1]}" if sizes[0] != sizes[1] else "of other numbers"
    hashes = f"{then['sha256'][:12]} -> {scene['sha256'][:12]}"
    return Change("scene", f"the golden is of another scene, {how} ({hashes})", True)


def _of_verdict(golden: Golden, scene: Mapping[str, Any]) -> Iterator[Change]:
    """Compare verdicts, as far as the lanes that are here can repeat the golden's."""
    if scene["judgement"]["message"]:
        return
    here = {lane["name"] for lane in scene["renderers"] if lane["status"] == "ok"}
    then, now = golden.about["verdict"], scene["verdict"]
    blamed = [lane for lane in golden.about["blame"] if lane in here]
    whole = here == set(golden.classes) and now != "incomplete"
    if set(blamed) != set(scene["blame"]) or (whole and then != now):
        yield Change(
            "verdict", f"{_verdict(then, blamed)} -> {_verdict(now, scene['blame'])}", True
        )


def _verdict(word: str, blame: Sequence[str]) -> str:
    return f"{word} (blamed: {', '.join(blame)})" if blame else word


def _of_lane(then: Mapping[str, Any], now: Mapping[str, Any]) -> Iterator[Change]:
    statuses = then["status"], now["status"]
    if statuses[0] != statuses[1] and "unsupported" in statuses:
        text = f"{statuses[0]} -> {statuses[1]}: {now['message'] or 'there is an image now'}"
        # One that is missing or has failed is not known to support the scene or not.
        yield Change("lane", text, set(statuses) <= {"ok", "unsupported"}, now["name"])
    if now["status"] == "ok" and then["version"] != now["version"]:
        text = f"version {then['version']} -> {now['version']}"
        yield Change("lane", text, False, now["name"])


def of_classes(
    lane: str, then: NDArray[np.uint8], now: NDArray[np.uint8], same_processor: bool = True
) -> Iterator[Change]:
    """Compare the classes of one lane pixel by pixel; both (v_res, h_res)."""
    wrong, suspect = now == Class.WRONG, now == Class.SUSPECT
    newly = {
        "now wrong": (wrong & (then != Class.WRONG), Class.WRONG),
        "equal, now suspect": (suspect & (then == Class.EQUAL), Class.SUSPECT),
        "explained, now suspect": (suspect & np.isin(then, EXPLAINED), None),
    }
    for text, (which, kind) in newly.items():
        if which.any():
            fails = kind is not None and (same_processor or _grew(then == kind, now == kind))
            yield _of_pixels(lane, text, which, then, now, fails)
    less = (then == Class.WRONG) & ~wrong
    if less.any():
        yield _of_pixels(lane, "no longer wrong", less, then, now, False)
    for kind in EXPLAINED:
        before, after = (int(np.count_nonzero(classes == kind)) for classes in (then, now))
        if before != after:
            room = 4 + 4 * math.sqrt(before + after)
            text = f"{NAMES[kind]} {before:,} -> {after:,}{_whereto(kind, then, now)}"
            yield Change("classes", text, abs(after - before) > room, lane)


def _grew(then: NDArray[np.bool_], now: NDArray[np.bool_]) -> bool:
    """Say whether a class has more pixels than another processor accounts for."""
    before, after = int(np.count_nonzero(then)), int(np.count_nonzero(now))
    room = 2 * math.sqrt(before + after) if before else 0.0
    return after - before > room


def _of_pixels(
    lane: str,
    text: str,
    which: NDArray[np.bool_],
    then: NDArray[np.uint8],
    now: NDArray[np.uint8],
    fails: bool,
) -> Change:
    count = int(np.count_nonzero(which))
    pixels = tuple((int(row), int(column)) for row, column in np.argwhere(which)[:NAMED])
    moves = ", ".join(f"({r}, {c}) {NAMES[then[r, c]]} -> {NAMES[now[r, c]]}" for r, c in pixels)
    more = f" and {count - NAMED:,} more" if count > NAMED else ""
    plural = "pixel" if count == 1 else "pixels"
    return Change("classes", f"{count:,} {plural} {text}: {moves}{more}", fails, lane, pixels)


def _whereto(kind: Class, then: NDArray[np.uint8], now: NDArray[np.uint8]) -> str:
    """Say what became of the pixels that were explained so."""
    left = np.bincount(now[(then == kind) & (now != kind)], minlength=len(NAMES))
    parts = [f"{count:,} {name}" for name, count in zip(NAMES, left, strict=True) if count]
    return f", now {', '.join(parts)}" if parts else ""


def _of_pairs(golden: Golden, scene: Mapping[str, Any]) -> Iterator[Change]:
    then = {(pair["a"], pair["b"]): pair for pair in golden.about["pairs"]}
    for pair in scene["pairs"]:
        before = then.get((pair["a"], pair["b"]))
        if before is None or None in (before["pixels"], pair["pixels"]):
            continue
        for key, bound in (("over_1_255", "1/255"), ("over_1e_4", "1e-4")):
            if before[key] != pair[key]:
                text = (
                    f"against {pair['a']}, pixels beyond {bound}: {before[key]:,} -> {pair[key]:,}"
                )
                yield Change("metrics", text, False, pair["b"])
