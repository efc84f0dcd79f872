"""The native tracer's fingerprint: what in it counts as changed, and how a pixel is named."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from crosstrace.harness.api import load
from crosstrace.harness.fingerprint import Fingerprint, reduced, take, take_and_compare
from crosstrace.translators.native.envelope import envelope
from crosstrace.translators.native.truth import certify
from crosstrace.translators.scene import Scene


@pytest.fixture(scope="module")
def scene() -> Scene:
    """Give a scene with glass, larger than its reduced image."""
    return load("vidro4", size=(120, 160))


@pytest.fixture(scope="module")
def taken(scene: Scene) -> Fingerprint:
    """Give its fingerprint."""
    return take(scene, threads=1)


@pytest.mark.parametrize(
    ("size", "small"), [((480, 640), (60, 80)), ((61, 81), (61, 81)), ((1, 1000), (1, 77))]
)
def test_the_reduced_image_is_a_whole_fraction(
    scene: Scene, size: tuple[int, int], small: tuple[int, int]
) -> None:
    """An eighth of a course scene; a hard scene is kept whole."""
    assert reduced(scene.resized(*size)).shape[:2] == small


def test_nothing_differs_when_nothing_changed(scene: Scene, taken: Fingerprint) -> None:
    """On any number of threads."""
    now, found = take_and_compare(scene, taken, threads=2)
    assert found == []
    assert now.sha256 == taken.sha256


def test_a_changed_value_is_named_with_both_of_its_values_and_classes(
    scene: Scene, taken: Fingerprint
) -> None:
    """A thousandth is no rounding."""
    image = taken.image.copy()
    image[31, 7, 1] += 1e-3
    _, (found,) = take_and_compare(scene, replace(taken, image=image))
    assert found.fails and found.pixels == ((31, 7),)
    assert f"the native image at {image.shape[0]}x{image.shape[1]}: pixel (31, 7): " in found.text
    assert f"{image[31, 7, 1]:.17g}" in found.text
    assert "the golden value wrong and this one equal" in found.text


def test_a_value_that_moved_within_rounding_is_noted(scene: Scene, taken: Fingerprint) -> None:
    """Behind glass double keeps fewer digits: what an honest double may return is excused."""
    small = reduced(scene)
    pixels = np.arange(small.v_res * small.h_res)
    error = 4 * 2.0**-53
    sample = envelope(small, pixels=pixels, error=error, samples=1, seed=7).colors[:, 0]
    image = sample.reshape(taken.image.shape)
    assert (image != taken.image).any()
    _, found = take_and_compare(scene, replace(taken, image=image))
    assert found and not any(difference.fails for difference in found)


def test_a_value_that_is_not_a_number_has_changed(scene: Scene, taken: Fingerprint) -> None:
    """No comparison with NaN may count as equal."""
    image = taken.image.copy()
    image[0, 0] = np.nan
    _, (found,) = take_and_compare(scene, replace(taken, image=image))
    assert found.fails and found.pixels == ((0, 0),)


def test_a_changed_tree_is_named(scene: Scene, taken: Fingerprint) -> None:
    """One that no rounding of double produces at its pixel."""
    trees = taken.trees.copy()
    trees[5, 6] ^= np.uint64(1)
    _, (found,) = take_and_compare(scene, replace(taken, trees=trees))
    assert found.fails and found.pixels == ((5, 6),)
    assert f"pixel (5, 6): {trees[5, 6]:016x} -> {taken.trees[5, 6]:016x}" in found.text


def test_a_changed_tree_at_full_size_is_named_by_row_and_column(
    scene: Scene, taken: Fingerprint
) -> None:
    """Digests of rows and columns cross in the pixel."""
    rows, columns = taken.row_digests.copy(), taken.column_digests.copy()
    rows[17] ^= np.uint64(1)
    columns[90] ^= np.uint64(1)
    golden = replace(taken, row_digests=rows, column_digests=columns, sha256="another")
    _, (found,) = take_and_compare(scene, golden)
    assert found.fails and found.pixels == ((17, 90),)
    assert "the ray trees at 120x160 changed in rows 17, columns 90" in found.text


def test_the_samples_of_rounding_have_the_trees_that_the_tracer_reports(
    scene: Scene, taken: Fingerprint
) -> None:
    """With an error far below double's own, every tree is the unperturbed one."""
    small = reduced(scene)
    pixels = np.arange(small.v_res * small.h_res)
    sampled = envelope(small, pixels=pixels, error=1e-300, samples=1).trees[:, 0]
    assert np.array_equal(sampled.reshape(taken.trees.shape), taken.trees)


def test_a_tree_that_real_arithmetic_leaves_open_may_change() -> None:
    """Two spellings of one plane lie at the same place: either may be hit."""
    scene = load("coincident-respelled")
    taken = take(scene)
    other = replace(taken, trees=taken.trees ^ np.uint64(1))
    undecidable = certify(scene).undecidable
    _, found = take_and_compare(scene, other)
    assert undecidable.sum() > 1000 and {d.fails for d in found} == {False, True}
    # The one pixel of this scene that is decided.
    assert found[0].pixels == tuple((int(r), int(c)) for r, c in np.argwhere(~undecidable))


def test_a_tree_that_rounding_may_produce_may_change() -> None:
    """Where a light grazes the floor, double's own errors decide what is lit."""
    scene = load("grazing-shadow")
    taken = take(scene)
    pixels = np.arange(taken.trees.size)
    sampled = envelope(scene, pixels=pixels, error=4 * 2.0**-53, samples=1, seed=5)
    trees = sampled.trees[:, 0].reshape(taken.trees.shape)
    assert np.count_nonzero(trees != taken.trees) > 20
    _, found = take_and_compare(scene, replace(taken, trees=trees))
    assert {difference.fails for difference in found} == {False}


def test_another_reduced_size_is_told(scene: Scene, taken: Fingerprint) -> None:
    """A golden of other shape is not compared pixel by pixel."""
    cut = replace(taken, image=taken.image[:-1], trees=taken.trees[:-1])
    _, (found,) = take_and_compare(scene, cut)
    assert found.fails and "instead of" in found.text
