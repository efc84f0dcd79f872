"""The job that judges one scene of a run: truth, classes of every lane, regions, blame.

It runs where the scratch files are and returns a small record; the pictures of the classes go to
the report's folder.
"""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crosstrace.harness import (
    blame,
    colormap,
    declared,
    images,
    ray_path,
    regions,
    shown,
)
from crosstrace.harness.classes import Class, Classified, classify
from crosstrace.harness.lanes import REFERENCE, loaded
from crosstrace.harness.store import Place
from crosstrace.translators.native import truth
from crosstrace.translators.native.explain import explain
from crosstrace.translators.readings import deviating
from crosstrace.translators.renderer import RenderOptions
from crosstrace.translators.scene import Scene

Array = NDArray[np.float64]

#: Rows of the image in which float128, a hundred times as slow as double, is held against the
#: enclosures.
CHECKED_ROWS = 1

#: Rays of a tree that are looked at for its outline.
_MOST_RAYS = 1000


@dataclass(frozen=True)
class Exhibit:
    """One lane's image as a scratch file of float64, and the half step of its output."""

    lane: str
    pixels: Path
    half_step: float


@dataclass(frozen=True)
class Judgement:
    """What is found about one scene; `classified` and `found` by lane.

    `found` are a lane's regions of wrong and suspect pixels, and how many there are in all,
    `declared` what of their ray trees its ledger names without a reading that reproduces it.
    `violations` counts pixels in the checked rows whose float128 value leaves its enclosure.
    """

    known: truth.Enclosures
    classified: Mapping[str, Classified]
    found: Mapping[str, tuple[list[regions.Region], int]]
    declared: Mapping[str, list[declared.Met]]
    verdict: blame.Verdict
    stages: Mapping[str, Mapping[str, str]]
    violations: int
    seconds: Mapping[str, float]


def judge(
    scene: Scene,
    lanes: Mapping[str, tuple[Array, float]],
    readings: Mapping[str, str] | None = None,
    threads: int = 0,
    known: truth.Enclosures | None = None,
) -> Judgement:
    """Judge images (v_res, h_res, 3) of one scene, given by lane with their half steps.

    The truth is that of `readings`, which only the reference can have been asked for; `known` are
    its enclosures where somebody has them already.
    """
    started = time.perf_counter()
    known = known or truth.certify(scene, readings, threads=threads)
    certified = time.perf_counter()
    ledgers = {lane: loaded(lane).ledger(scene) for lane in lanes}
    classified = {
        lane: classify(
            scene, known, image, ledgers[lane],
            half_step=half_step, readings=readings, threads=threads,
        )
        for lane, (image, half_step) in lanes.items()
    }  # fmt: skip
    classed = time.perf_counter()
    violations = truth.violations(scene, readings, known, _rows(scene, classified))
    testimonies = [
        blame.Testimony(lane, image, classified[lane], loaded(lane).capabilities.stages)
        for lane, (image, _) in lanes.items()
    ]
    verdict = blame.judge(
        testimonies, REFERENCE, violations, like_reference=not deviating(readings or {})
    )
    images_of = {lane: image for lane, (image, _) in lanes.items()}
    found = describe(scene, images_of, known, classified, readings, threads)
    named = {
        lane: declared.met(scene, ledgers[lane], one.pixels(Class.WRONG, Class.SUSPECT), readings)
        for lane, one in classified.items()
    }
    seconds = {"certify": certified - started, "classify": classed - certified,
               "describe": time.perf_counter() - classed}  # fmt: skip
    return Judgement(
        known, classified, found, named, verdict, blame.table(testimonies), violations, seconds
    )


def judge_files(
    scene: Scene,
    readings: Mapping[str, str],
    exhibits: Sequence[Exhibit],
    threads: int,
    places: Mapping[str, Place],
    version: str,
    common: Place,
) -> dict[str, Any]:
    """Judge the lanes' scratch files, draw their classes at `places`; return the record.

    What is of no lane in particular goes to `common`: the object that each pixel shows, and the
    pixels to show exactly.
    """
    lanes = {e.lane: (np.load(e.pixels), e.half_step) for e in exhibits}
    found = judge(scene, lanes, readings, threads)
    far = {lane: found.known.distance(image) for lane, (image, _) in lanes.items()}
    started = time.perf_counter()
    left = shown.files(scene, {lane: image for lane, (image, _) in lanes.items()}, found, far,
                       readings, threads, common)  # fmt: skip
    seconds = {**found.seconds, "pixels": time.perf_counter() - started}
    return {
        "message": "",
        "verdict": found.verdict.word,
        "blame": list(found.verdict.blame),
        "agreed_against_reference": found.verdict.against,
        "truth": {
            "certified_fraction": found.known.certified_fraction,
            "undecidable": int(found.known.undecidable.sum()),
            "closed": dict(found.known.closed),
            "float128_outside": found.violations,
        },
        "stages": {stage: dict(row) for stage, row in found.stages.items()},
        "seconds": seconds,
        "images": left,
        "lanes": {
            lane: {
                "classes": classified.counts,
                "tolerance": classified.tolerance_at_one,
                "regions": [asdict(region) for region in found.found[lane][0]],
                "n_regions": found.found[lane][1],
                "excess": shown.excess(classified, far[lane]),
                "declared": [asdict(met) for met in found.declared[lane]],
                "image": _draw(classified, places[lane], version),
            }
            for lane, classified in found.classified.items()
        },
    }


def _draw(classified: Classified, place: Place, version: str) -> dict[str, str] | None:
    """Draw the classes where not all pixels are equal."""
    if not classified.classes.any():
        return None
    picture = colormap.class_picture(classified.classes)
    images.write_pixels(place.file(".classes.png"), picture, {"crosstrace:version": version})
    return place.entry(".classes.png")


def _rows(scene: Scene, classified: Mapping[str, Classified]) -> list[int]:
    """Choose the rows to check: those with most unexplained pixels, else evenly spread ones."""
    bad = np.zeros(scene.v_res, np.int64)
    for one in classified.values():
        bad += one.pixels(Class.WRONG, Class.SUSPECT).sum(axis=1)
    worst = [int(row) for row in np.argsort(-bad, kind="stable")[:CHECKED_ROWS] if bad[row]]
    step = max(1, scene.v_res // CHECKED_ROWS)
    spread = range(step // 2, scene.v_res, step)
    return sorted({*worst, *spread[: CHECKED_ROWS - len(worst)]})


def describe(
    scene: Scene,
    lanes: Mapping[str, Array],
    known: truth.Enclosures,
    classified: Mapping[str, Classified],
    readings: Mapping[str, str] | None = None,
    threads: int = 0,
) -> dict[str, tuple[list[regions.Region], int]]:
    """Find each lane's regions of wrong and suspect pixels, and how many there are in all.

    The reference is rendered for its side outputs, but only where there is something to describe.
    """
    bad = {lane: one.pixels(Class.WRONG, Class.SUSPECT) for lane, one in classified.items()}
    if not any(which.any() for which in bad.values()):
        return {lane: ([], 0) for lane in lanes}
    options = RenderOptions(threads=threads, readings=dict(readings or {}), layers=True)
    traced = loaded(REFERENCE).render(scene, options)
    with np.errstate(invalid="ignore"):
        true = np.where(np.isfinite(known.lo), 0.5 * (known.lo + known.hi), traced.image)
    found = {
        lane: regions.find(bad[lane], image, true, traced.layers) for lane, image in lanes.items()
    }
    return {
        lane: ([_with_tree(scene, region, readings) for region in some], count)
        for lane, (some, count) in found.items()
    }


def _with_tree(
    scene: Scene, region: regions.Region, readings: Mapping[str, str] | None
) -> regions.Region:
    tree = explain(scene, region.row, region.column, readings, max_rays=_MOST_RAYS)
    return replace(region, tree=ray_path.outline(tree))
