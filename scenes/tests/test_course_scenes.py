"""The packaged course scenes: all there, well formed, our own, and free of accidental ties."""

from __future__ import annotations

import json
import os
from importlib.resources import files
from itertools import combinations
from pathlib import Path

import numpy as np
import pytest

from crosstrace.translators.course import load
from crosstrace.translators.scene import KT, N, Scene

FOLDER = Path(str(files("crosstrace.scenes") / "course"))
INDEX = json.loads((FOLDER / "index.json").read_text(encoding="utf-8"))
DELIVERIES = {
    1: ("polonia", "japao", "canto", "olho", "ilhas"),
    2: ("terra", "piramide", "eclipse", "venn", "sinuca"),
    3: ("espelho0", "espelho1", "espelho2", "espelho3", "vidro2", "vidro4", "bolha2", "bolha4"),
}
NAMES = [name for names in DELIVERIES.values() for name in names]


def scene(name: str) -> Scene:
    return load(FOLDER / f"{name}.txt")


def test_the_index_lists_the_eighteen_scenes_in_the_order_of_the_specification() -> None:
    """Each name once, with its own file, its delivery, a title and a sentence; no file besides."""
    assert [entry["name"] for entry in INDEX] == NAMES
    assert {path.name for path in FOLDER.glob("*.txt")} == {f"{name}.txt" for name in NAMES}
    for entry in INDEX:
        assert entry["file"] == f"{entry['name']}.txt"
        assert entry["name"] in DELIVERIES[entry["delivery"]]
        assert entry["title"]
        assert entry["about"].endswith(".")


@pytest.mark.parametrize("name", NAMES)
def test_a_scene_parses_as_its_delivery_at_the_course_s_resolution(name: str) -> None:
    """480 × 640, lights from the second delivery on, a depth only in the third."""
    parsed = scene(name)
    assert name in DELIVERIES[parsed.delivery]
    assert (parsed.v_res, parsed.h_res) == (480, 640)
    assert (parsed.n_lights > 0) == (parsed.delivery > 1)
    assert parsed.max_depth == (int(name[-1]) if parsed.delivery == 3 else 0)


@pytest.mark.parametrize("stem", ["espelho", "vidro", "bolha"])
def test_scenes_of_one_stem_differ_in_nothing_but_their_depth(stem: str) -> None:
    """Line by line the same text, but for the seventh line."""
    texts = [(FOLDER / f"{name}.txt").read_text().splitlines() for name in NAMES if stem in name]
    assert len(texts) > 1
    assert len({text[6] for text in texts}) == len(texts)
    assert len({(*text[:6], *text[7:]) for text in texts}) == 1


def test_the_bubbles_are_thinner_than_their_surroundings_and_the_glass_is_denser() -> None:
    """Every transparent object of bolha has n < 1, of vidro n > 1."""
    for name, sign in (("bolha2", -1), ("vidro2", 1)):
        clear = scene(name).material[scene(name).material[:, KT] > 0]
        assert len(clear) > 1
        assert (sign * (clear[:, N] - 1) > 0).all()


@pytest.mark.parametrize("name", NAMES)
def test_no_scene_has_a_degeneracy_that_is_not_its_point(name: str) -> None:
    """No eye or light on a surface, no light in a ball, no twins, no ball that cuts into glass."""
    parsed = scene(name)
    is_ball = parsed.is_sphere
    balls, clear = parsed.geometry[is_ball], parsed.material[is_ball, KT] > 0
    centre, radius = balls[:, :3], balls[:, 3]
    for point in (parsed.eye, *parsed.lights[:, 3:]):
        assert (np.abs(np.linalg.norm(point - centre, axis=1) - radius) > 1e-3).all()
        for plane in parsed.geometry[~is_ball]:
            normal = plane[3:] / np.linalg.norm(plane[3:])
            assert abs(normal @ (point - plane[:3])) > 1e-3
    for light in parsed.lights[:, 3:]:
        assert (np.linalg.norm(light - centre, axis=1) > radius).all()
    assert len({row.tobytes() for row in parsed.geometry}) == len(parsed)
    for i, j in combinations(range(len(balls)), 2):
        if clear[i] or clear[j]:
            assert np.linalg.norm(centre[i] - centre[j]) > radius[i] + radius[j]


@pytest.mark.parametrize("name", NAMES)
def test_a_scene_shares_no_object_light_or_camera_with_the_official_ones(name: str) -> None:
    """Compare the numbers of every camera, object and light, whatever their spelling."""
    folder = os.environ.get("CROSSTRACE_COURSE")
    if not folder:
        pytest.skip("CROSSTRACE_COURSE does not name a folder of the course's official scenes")

    def parts(parsed: Scene) -> set[bytes]:
        things = np.column_stack([parsed.color, parsed.material, parsed.geometry])
        camera = np.concatenate([parsed.eye, parsed.target])
        return {row.tobytes() for row in (*things, *parsed.lights, camera)}

    official = list(Path(folder).glob("*.txt"))
    assert official
    for path in official:
        shared = len(parts(scene(name)) & parts(load(path)))
        assert shared == 0, path.name
