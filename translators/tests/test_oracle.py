"""The oracle earns its name on the course's official images and on pixels known in closed form."""

from __future__ import annotations

from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

OFFICIAL = {
    "japao": {}, "olho": {}, "terra": {}, "piramide": {"plane_normal": "raw"}, "venn": {},
    "espelho0": {}, "espelho2": {}, "vidro4": {}, "bolha2": {},
}  # fmt: skip
IDENTICAL = {"piramide", "japao", "olho", "venn", "espelho2"}


@pytest.mark.parametrize("name", OFFICIAL)
def test_the_oracle_draws_the_official_image(oracle: ModuleType, official: Path, name: str) -> None:
    """No pixel differs where 255·v is further than 1e-9 from an integer; there by one level."""
    skimage_io = pytest.importorskip("skimage.io")
    result = oracle.render(oracle.read((official / f"{name}.txt").read_text()), **OFFICIAL[name])
    mine = oracle.to_bytes(result.image).astype(int)
    theirs = skimage_io.imread(official / f"{name}.png")[..., :3].astype(int)
    level = 255 * result.image / np.maximum(1, result.image.max(axis=-1, keepdims=True))
    differs = mine != theirs
    assert not (differs & (np.abs(level - np.round(level)) > 1e-9)).any()
    assert np.abs(mine - theirs).max() <= 1
    if name in IDENTICAL:
        assert not differs.any()


HEAD = "1 1\n1 1\n0 -5 0\n0 0 0\n0 0 1\n51 102 153\n"


def test_a_mirror_facing_the_eye_returns_the_background(oracle: ModuleType) -> None:
    """Local 0, kr = 0.5: half of B comes back, and nothing at depth 0."""
    scene = HEAD + "{}\n1\n255 255 255 0 0 0 1 0.5 0 1 / 0 0 0 0 -1 0\n255 255 255\n0\n"
    pixel = oracle.render(oracle.read(scene.format(1))).image[0, 0]
    assert pixel == pytest.approx([0.1, 0.2, 0.3], abs=1e-15)
    assert not oracle.render(oracle.read(scene.format(0))).image.any()
    background = oracle.render(oracle.read(scene.format(0)), exhausted="background").image[0, 0]
    assert background == pytest.approx([0.1, 0.2, 0.3], abs=1e-15)


def test_total_reflection_takes_all_and_each_reading_of_it_its_own_share(
    oracle: ModuleType,
) -> None:
    """At 45° into a medium of n = 0.5 nothing is refracted: kr acts as 1, kr + kt, kr, …."""
    scene = HEAD + "1\n1\n0 0 0 0 0 0 1 0.25 0.5 0.5 / 0 0 0 0 -1 1\n0 0 0\n0\n"
    shares = {"full": 1, "add": 0.75, "ignore": 0.25, "plus-one": 1.25, "needs-kr": 1}
    for tir, share in shares.items():
        pixel = oracle.render(oracle.read(scene), tir=tir).image[0, 0]
        assert pixel == pytest.approx([0.2 * share, 0.4 * share, 0.6 * share], abs=1e-15), tir


def test_a_light_straight_above_gives_lambert_and_a_blocker_takes_it(oracle: ModuleType) -> None:
    """kd·cd·c·cos θ with cos θ = 1, and the ambient part alone behind a blocker."""
    floor = "255 255 255 0.25 0.5 0 1 / 0 0 0 0 -1 0"
    lid = "0 0 0 0 0 0 1 * 0 -9 0 1"
    text = HEAD + "{}\n{}\n255 255 255\n1\n255 0 0 0 -20 0\n"
    lit = oracle.render(oracle.read(text.format(1, floor))).image[0, 0]
    assert lit == pytest.approx([0.75, 0.25, 0.25], abs=1e-15)
    dark = oracle.read(text.format(2, f"{floor}\n{lid}"))
    assert oracle.render(dark).image[0, 0] == pytest.approx([0.25, 0.25, 0.25], abs=1e-15)


def test_an_eye_on_a_plane_or_a_sphere_does_not_see_that_surface(oracle: ModuleType) -> None:
    """The zero root is left out: the plane is not seen, the sphere only from its inside."""
    plane = HEAD + "1\n255 0 0 / 0 -5 0 0 -1 0.3\n"
    assert oracle.render(oracle.read(plane)).object[0, 0] == -1
    sphere = HEAD + "1\n255 0 0 * 0 -4.7 0 0.3\n"
    result = oracle.render(oracle.read(sphere))
    assert result.object[0, 0] == 0
    assert result.t[0, 0] == pytest.approx(0.6, abs=1e-12)


def test_equal_distances_are_the_first_object_s(oracle: ModuleType) -> None:
    """Two identical spheres of different colours: the first in the file is seen, on no edge."""
    result = oracle.render(oracle.read(HEAD + "2\n255 0 0 * 0 0 0 1\n0 255 0 * 0 0 0 1\n"))
    assert result.image[0, 0].tolist() == [1, 0, 0]
    assert result.margin[0, 0] > 0.1


def test_tracked_nesting_makes_equal_glass_within_glass_invisible(oracle: ModuleType) -> None:
    """With absolute indices a ball inside a ball of the same n bends nothing."""
    big = "0 0 0 0 0 0 1 0 1 1.5 * 0 0 0 2"
    small = "0 0 0 0 0 0 1 0 1 1.5 * 0.1 0.2 0.3 0.7"
    wall = "255 0 0 1 0 0 1 0 0 1 / 0 30 0 0 -1 1.3"
    text = "9 9\n0.1 1\n0 -5 0\n0 0 0\n0 0 1\n51 102 153\n5\n{}\n255 255 255\n0\n"
    alone = oracle.render(oracle.read(text.format(f"2\n{big}\n{wall}")), nesting="tracked")
    nested = oracle.read(text.format(f"3\n{big}\n{small}\n{wall}"))
    both = oracle.render(nested, nesting="tracked")
    np.testing.assert_allclose(both.image, alone.image, atol=1e-12)
    assert np.abs(oracle.render(nested).image - alone.image).max() > 0.01
