"""The pixels that a report shows exactly: which, and that their numbers are right."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest

from crosstrace.harness import judging, maps, witnesses
from crosstrace.harness.classes import NAMES
from crosstrace.harness.sources import find
from crosstrace.harness.spread import EDGES
from crosstrace.harness.store import Place
from crosstrace.translators.native.adapter import Native
from crosstrace.translators.native.truth import certify
from crosstrace.translators.renderer import RenderOptions


@pytest.fixture(scope="module")
def judged(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """Judge the reference, and an image of `mitsuba-f64` with three defects, of one scene."""
    folder = tmp_path_factory.mktemp("judged")
    (source,) = find(["vidro4"], size=(24, 32))
    native = Native().render(source.scene, RenderOptions(layers=True))
    other = native.image.copy()
    other[3:6, 4:9] += 0.25
    other[20, 30] += 1e-3
    other[0, 31, 0] = np.nan
    exhibits = []
    for lane, image in (("native", native.image), ("mitsuba-f64", other)):
        np.save(folder / f"{lane}.npy", image)
        exhibits.append(judging.Exhibit(lane, folder / f"{lane}.npy", 0.0))
    places = {exhibit.lane: Place(folder, exhibit.lane) for exhibit in exhibits}
    record = judging.judge_files(
        source.scene, {}, exhibits, 1, places, "test", Place(folder, "_scene")
    )
    pixels = json.loads((folder / record["images"]["pixels"]["file"]).read_text())
    objects = maps.read(folder / record["images"]["objects"]["file"])["object"]
    images = {"native": native.image, "mitsuba-f64": other}
    return {"scene": source.scene, "record": record, "pixels": pixels, "objects": objects,
            "images": images, "layers": native.layers}  # fmt: skip


def test_each_defect_is_shown_and_the_worst_of_each_region_first(judged: dict[str, Any]) -> None:
    """The peak of every region comes before the rest of the largest."""
    found = [(pixel["row"], pixel["col"]) for pixel in judged["pixels"]["pixels"]]
    assert {(20, 30), (0, 31)} < set(found[:3])
    block = {(row, col) for row in range(3, 6) for col in range(4, 9)}
    assert block <= set(found)
    assert len(found) == len(set(found))


def test_values_are_those_of_the_images_to_the_last_bit(judged: dict[str, Any]) -> None:
    """What is not a number is null; classes are names."""
    for pixel in judged["pixels"]["pixels"]:
        for lane, image in judged["images"].items():
            shown = pixel["lanes"][lane]
            true = image[pixel["row"], pixel["col"]].tolist()
            assert shown["value"] == [None if np.isnan(value) else value for value in true]
            assert shown["class"] in NAMES
    wrong = {(p["row"], p["col"]): p["lanes"]["mitsuba-f64"] for p in judged["pixels"]["pixels"]}
    assert wrong[20, 30]["class"] == "wrong"
    assert wrong[20, 30]["off"] == pytest.approx(1e-3, rel=1e-6)
    assert wrong[0, 31]["off"] is None


def test_enclosures_are_those_of_the_whole_frame(judged: dict[str, Any]) -> None:
    """Certified again for the few pixels, they are the same."""
    known = certify(judged["scene"])
    for pixel in judged["pixels"]["pixels"]:
        at = pixel["row"], pixel["col"]
        assert pixel["enclosure"]["lo"] == known.lo[at].tolist()
        assert pixel["enclosure"]["hi"] == known.hi[at].tolist()


def test_ray_trees_add_up_to_the_reference(judged: dict[str, Any]) -> None:
    """The local terms of all rays but shadow rays are the pixel's colour, to the digits kept."""
    trees = 0
    for pixel in judged["pixels"]["pixels"]:
        tree = pixel["tree"]
        if tree is None or tree["n_rays"] > len(tree["rays"]):
            continue
        trees += 1
        sums = np.sum([ray["adds"] for ray in tree["rays"] if ray["kind"] != "shadow"], axis=0)
        true = judged["images"]["native"][pixel["row"], pixel["col"]]
        assert np.allclose(sums, true, atol=1e-5)
        assert pixel["object"] == judged["layers"]["object"][pixel["row"], pixel["col"]]
    assert trees > 3


def test_objects_are_those_of_the_reference(judged: dict[str, Any]) -> None:
    """The map says what every pixel shows."""
    assert np.array_equal(judged["objects"], judged["layers"]["object"])


def test_pixels_that_are_left_out_are_counted(
    judged: dict[str, Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    """A cap keeps the first, and the count stays that of all."""
    beyond = judged["pixels"]["beyond"]
    assert 17 <= beyond <= len(judged["pixels"]["pixels"])
    monkeypatch.setattr(witnesses, "MOST_PIXELS", 5)
    monkeypatch.setattr(witnesses, "MOST_TREES", 2)
    images = judged["images"]
    found = judging.judge(
        judged["scene"], {lane: (image, 0.0) for lane, image in images.items()}, threads=1
    )
    far = {lane: found.known.distance(image) for lane, image in images.items()}
    cut = witnesses.record(judged["scene"], images, found, far, {}, 1)
    assert len(cut["pixels"]) == 5 and cut["beyond"] == beyond
    assert [pixel["tree"] is not None for pixel in cut["pixels"]] == [True] * 2 + [False] * 3


@pytest.mark.parametrize("tolerance", [EDGES[24], 1e-3, 0.2, 0.3])
def test_a_tolerance_lets_pass_what_the_counts_say(
    judged: dict[str, Any], tolerance: float
) -> None:
    """Judged again with it, so many pixels are still not equal: the page's promise is exact."""
    image = judged["images"]["mitsuba-f64"]
    again = judging.judge(judged["scene"], {"mitsuba-f64": (image, tolerance)}, threads=1)
    classes = again.classified["mitsuba-f64"].counts
    left = sum(classes.values()) - classes["equal"] - classes["undecidable"]
    promised = 0
    for name, spread in judged["record"]["lanes"]["mitsuba-f64"]["excess"].items():
        if name != "undecidable":
            promised += spread["beyond"]
            promised += sum(n for edge, n in spread["counts"].items() if float(edge) > tolerance)
    assert left == promised


def test_distance_is_to_the_nearest_possible_value() -> None:
    """0 inside, the overshoot of the worst channel outside, infinite for no number."""
    (source,) = find(["edge-centres"])
    known = certify(source.scene)
    middle = 0.5 * (known.lo + known.hi)
    enclosed = np.isfinite(middle).all(axis=-1) & ~known.undecidable
    assert enclosed.any() and known.undecidable.any()
    assert (known.distance(middle)[enclosed] == 0).all()
    moved = middle + np.array([0.0, -0.5, 0.25])
    assert np.allclose(known.distance(moved)[enclosed], 0.5, atol=1e-8)
    assert np.isinf(known.distance(np.full_like(middle, np.nan))).all()
    for i, at in enumerate(np.argwhere(known.undecidable)[:20]):
        some = known.alternatives[i, : known.n_alternatives[i]]
        image = middle.copy()
        for lo, _ in some:
            image[tuple(at)] = lo
            assert known.distance(image)[tuple(at)] == 0
