"""Regions of wrong pixels: found, described by what is traced there, and told apart by kind."""

from __future__ import annotations

import numpy as np

from crosstrace.harness import regions

ROWS, COLUMNS = 30, 40


def layers(**more: np.ndarray) -> dict[str, np.ndarray]:
    """Return side outputs of one plane, object 0, with ambient light alone."""
    contributions = np.zeros((ROWS, COLUMNS, 6, 3))
    contributions[..., 0, :] = 0.5
    plain = {"object": np.zeros((ROWS, COLUMNS), np.int32),
             "tree": np.zeros((ROWS, COLUMNS), np.uint64),
             "contributions": contributions}  # fmt: skip
    return {**plain, **more}


def truth() -> np.ndarray:
    """Return a smooth picture, brighter to the right and below."""
    rows, columns = np.mgrid[0:ROWS, 0:COLUMNS]
    return np.stack([0.2 + rows / 100 + columns / 200 + rows * columns / 9000] * 3, axis=-1)


def block(top: int, left: int, size: int) -> np.ndarray:
    which = np.zeros((ROWS, COLUMNS), bool)
    which[top : top + size, left : left + size] = True
    return which


def test_nothing_wrong_is_no_region() -> None:
    """And costs no labelling."""
    assert regions.find(np.zeros((ROWS, COLUMNS), bool), truth(), truth(), layers()) == ([], 0)


def test_touching_pixels_are_one_region_and_the_largest_comes_first() -> None:
    """Corners touch too; the pixel furthest from the truth represents its region."""
    which = block(2, 2, 2) | block(4, 4, 2) | block(20, 20, 2)
    image = truth()
    image[which] += 0.1
    image[4, 5] += 0.3
    found, count = regions.find(which, image, truth(), layers())
    assert (count, found[0].pixels, found[1].pixels) == (2, 8, 4)
    assert (found[0].row, found[0].column) == (4, 5)
    assert found[0].box == (2, 2, 6, 6)
    assert abs(found[0].difference - 0.4) < 1e-12


def test_only_so_many_regions_are_described_and_all_are_counted() -> None:
    """A picture full of speckles does not make a record full of them."""
    which = np.zeros((ROWS, COLUMNS), bool)
    which[::3, ::3] = True
    found, count = regions.find(which, truth() + 1, truth(), layers())
    assert len(found) == regions.DESCRIBED < count == which.sum()


def test_a_region_is_named_after_what_is_traced_there() -> None:
    """An object's silhouette, a shadow's edge, a refraction, the background, or all of it."""
    which = block(10, 10, 4)
    image = truth()
    image[which] += 0.2

    def where(**more: np.ndarray) -> str:
        return regions.find(which, image, truth(), layers(**more))[0][0].where

    assert where() == "object 0"
    assert where(object=np.full((ROWS, COLUMNS), -1, np.int32)) == "the background"
    glass = layers()["contributions"].copy()
    glass[..., 4, :] = 0.9
    assert where(contributions=glass) == "the refraction of object 0"
    shine = layers()["contributions"].copy()
    shine[..., 2, :] = 0.9
    assert where(contributions=shine) == "the highlight of object 0"
    checker = np.indices((ROWS, COLUMNS)).sum(axis=0) % 2
    assert where(object=checker.astype(np.int32)).startswith("the silhouette of object")
    assert where(tree=checker.astype(np.uint64)) == "a shadow's edge on object 0"
    everywhere = np.ones((ROWS, COLUMNS), bool)
    found, _ = regions.find(everywhere, truth() + 0.1, truth(), layers())
    assert found[0].where == "the whole image"


def test_kinds_are_guessed() -> None:
    """A factor, a displacement, a dot, or none of these."""
    which, true = block(8, 8, 12), truth()

    def kind(image: np.ndarray, which: np.ndarray = which) -> str:
        return regions.find(which, image, true, layers())[0][0].kind

    assert kind(1.01 * true) == "gain 1.01"
    assert kind(np.roll(true, (1, 0), axis=(0, 1))) == "shift by 1 rows, 0 columns"
    assert kind(true + 0.3, block(5, 5, 1)) == "speckle"
    noise = np.random.default_rng(1).uniform(0, 0.5, true.shape)
    assert kind(true + noise) == "blob"
    assert kind(np.full_like(true, np.nan)) == "not a number"
