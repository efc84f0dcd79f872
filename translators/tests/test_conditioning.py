"""What rounding may do to a pixel: honest values are explained, others are not."""

from __future__ import annotations

from importlib.resources import as_file, files

import numpy as np
import pytest

from crosstrace.translators.course import load
from crosstrace.translators.errors import UsageError
from crosstrace.translators.ledger import Emulation
from crosstrace.translators.native.conditioning import (
    Arithmetic,
    Conditioned,
    Envelope,
    envelope,
    judge,
)
from crosstrace.translators.native.unexplained import Unexplained
from crosstrace.translators.registry import renderer
from crosstrace.translators.renderer import RenderOptions
from crosstrace.translators.scene import Scene

UNIT = 2.0**-24
FLOAT32 = Arithmetic(UNIT, 2.0, UNIT)
COURSE = (
    "polonia", "japao", "canto", "olho", "ilhas", "terra", "piramide", "eclipse", "venn", "sinuca",
    "espelho0", "espelho1", "espelho2", "espelho3", "vidro2", "vidro4", "bolha2", "bolha4",
)  # fmt: skip


def rendered(scene: Scene, precision: str = "f64") -> np.ndarray:
    return renderer("native").render(scene, RenderOptions(precision=precision)).image


def packaged(name: str) -> Scene:
    with as_file(files("crosstrace.scenes") / "course" / f"{name}.txt") as file:
        return load(file)


def small(name: str) -> Scene:
    return packaged(name).resized(60, 80)


def beyond_tolerance(scene: Scene) -> tuple[np.ndarray, np.ndarray]:
    """Return pixels (n,) of an honest float32 render that are over the tolerance, and values."""
    image, true = rendered(scene, "f32"), rendered(scene)
    off = np.abs(image - true).max(axis=-1) > 16 * UNIT * np.maximum(1, np.abs(image).max(axis=-1))
    pixels = np.flatnonzero(off)
    return pixels, image.reshape(-1, 3)[pixels]


def honest_answers(scene: Scene) -> np.ndarray:
    """What is said of the pixels of an honest float32 render that are over the tolerance."""
    pixels, values = beyond_tolerance(scene)
    return judge(scene, values, pixels=pixels, arithmetic=FLOAT32)


@pytest.mark.parametrize("name", ["ilhas", "terra", "sinuca", "espelho3", "vidro4", "bolha4"])
def test_an_honest_float32_image_is_explained(name: str) -> None:
    """No pixel is wrong and at most eight are suspect, glass and shadow acne included."""
    answers = honest_answers(small(name))
    assert not (answers == Conditioned.WRONG).any()
    assert (answers == Conditioned.SUSPECT).sum() <= 8


@pytest.mark.parametrize("name", ["sinuca", "vidro4", "bolha4"])
def test_proofs_rule_out_no_honest_value(name: str) -> None:
    """Without any sample, nothing of an honest float32 render is proven impossible."""
    scene = small(name)
    pixels, values = beyond_tolerance(scene)
    left = Unexplained(pixels, values, np.zeros(len(pixels)), FLOAT32)
    possible = left.take_possible([Emulation(scene, {})])
    assert len(pixels) > 0
    assert len(possible) == len(pixels)


@pytest.mark.slow
@pytest.mark.parametrize("name", COURSE)
def test_an_honest_float32_image_is_explained_at_full_size(name: str) -> None:
    """Every packaged course scene at 480 x 640."""
    answers = honest_answers(packaged(name))
    assert not (answers == Conditioned.WRONG).any()
    assert (answers == Conditioned.SUSPECT).sum() <= 8


def test_samples_without_an_error_are_the_render_itself() -> None:
    """The perturbed kernel is the same text: at error 0 it returns the same bits."""
    scene = small("vidro4")
    pixels = np.arange(0, 4800, 7)
    seen = envelope(scene, pixels=pixels, error=0.0, samples=2)
    expected = rendered(scene).reshape(-1, 3)[pixels]
    assert (seen.colors == expected[:, None]).all()
    assert not seen.unseen.any()


def test_samples_do_not_depend_on_threads_or_neighbours() -> None:
    """A sample is a function of seed, pixel and its own number."""
    scene = small("vidro2")
    pixels = np.arange(1200, 2400)
    one = envelope(scene, pixels=pixels, error=UNIT, samples=8, seed=3, threads=1)
    two = envelope(scene, pixels=pixels[::-1], error=UNIT, samples=8, seed=3, threads=2)
    assert (one.colors == two.colors[::-1]).all()
    assert (one.trees == two.trees[::-1]).all()


def test_what_such_arithmetic_returned_once_is_explained_where_shadows_are_a_toss_up() -> None:
    """One sample of every pixel is an image that rounding made, by construction."""
    scene = small("vidro4")
    pixels = np.arange(4800)
    values = envelope(scene, pixels=pixels, error=FLOAT32.error, samples=1, seed=77).colors[:, 0]
    answers = judge(scene, values, pixels=pixels, arithmetic=FLOAT32)
    assert (answers != Conditioned.EXPLAINED).sum() <= 8


def test_a_value_off_by_a_thousandth_is_not_explained() -> None:
    """Where the picture is smooth no tree's box is as wide as that."""
    scene = small("espelho3")
    pixels = np.arange(4800)
    values = rendered(scene).reshape(-1, 3) + 1e-3
    answers = judge(scene, values, pixels=pixels, arithmetic=FLOAT32)
    assert (answers == Conditioned.EXPLAINED).mean() < 0.02
    assert (answers == Conditioned.WRONG).mean() > 0.5


def test_a_hull_of_two_trees_does_not_explain_what_lies_between_their_boxes() -> None:
    """Two ray trees give 0 and 1, and a half is neither."""
    colors = np.zeros((1, 16, 3))
    colors[0, 8:] = 1.0
    colors += np.tile(np.linspace(-1e-6, 1e-6, 8), 2)[None, :, None]
    trees = np.repeat(np.array([[1, 2]], np.uint64), 8, axis=1)
    seen = Envelope(colors, trees)
    for value, inside in ((0.0, True), (1.0, True), (0.5, False)):
        assert seen.contains(np.full((1, 3), value)).item() is inside
        assert seen.in_hull(np.full((1, 3), value)).item()


def test_the_chance_of_a_new_tree_is_the_share_of_trees_met_once() -> None:
    """Good and Turing's estimate: 2 of 8 samples are alone in their tree."""
    trees = np.array([[1, 1, 1, 2, 2, 2, 3, 4]], np.uint64)
    assert Envelope(np.zeros((1, 8, 3)), trees).unseen.item() == 0.25


def test_the_chance_of_a_new_tree_falls_with_the_samples_that_were_taken() -> None:
    """Of all choices of m others: a tree met 4 of 8 times is missed by one with chance 4/7."""
    trees = np.array([[1, 1, 1, 1, 2, 2, 2, 2]], np.uint64)
    seen = Envelope(np.zeros((1, 8, 3)), trees)
    assert seen.unseen_among(0).item() == pytest.approx(1.0)
    assert seen.unseen_among(1).item() == pytest.approx(4 / 7)
    assert seen.unseen_among(7).item() == 0.0


def test_a_reading_without_a_real_meaning_is_refused() -> None:
    """A bound derived for one arithmetic means nothing to another."""
    with pytest.raises(UsageError, match="offset=bound"):
        judge(
            small("venn"), np.full((1, 3), 9.0), pixels=np.zeros(1, int), arithmetic=FLOAT32,
            readings={"offset": "bound"},
        )  # fmt: skip
