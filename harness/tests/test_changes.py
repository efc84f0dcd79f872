"""What of a change in the classes fails a check, and how it is told."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from crosstrace.harness.changes import Change, of_classes
from crosstrace.harness.classes import Class

SHAPE = (100, 100)


def classes(**counts: int) -> NDArray[np.uint8]:
    """Return a map whose last pixels are of the classes named, so many each."""
    flat = np.zeros(SHAPE[0] * SHAPE[1], np.uint8)
    end = len(flat)
    for name, count in counts.items():
        flat[end - count : end] = Class[name.upper()]
        end -= count
    return flat.reshape(SHAPE)


def found(
    then: NDArray[np.uint8], now: NDArray[np.uint8], same_processor: bool = True
) -> list[Change]:
    return list(of_classes("lane", then, now, same_processor))


def test_the_same_classes_are_no_change() -> None:
    """Whatever they are."""
    same = classes(wrong=100, suspect=50, model=200)
    assert found(same, same.copy()) == []


@pytest.mark.parametrize("before", ["equal", "rounding", "undecidable", "model", "suspect"])
def test_one_pixel_that_is_newly_wrong_fails(before: str) -> None:
    """It is named with both of its classes."""
    then, now = classes(), classes()
    then[3, 7], now[3, 7] = Class[before.upper()], Class.WRONG
    (change,) = (c for c in found(then, now) if c.fails)
    assert change.pixels == ((3, 7),)
    assert f"1 pixel now wrong: (3, 7) {before} -> wrong" in change.text


def test_an_equal_pixel_that_becomes_suspect_fails_and_an_explained_one_does_not() -> None:
    """The verdict caps suspect pixels; one that was certain must stay so."""
    then, now = classes(model=1), classes(suspect=1)
    assert not any(c.fails for c in found(then, now) if "suspect" in c.text)
    (change,) = found(classes(), classes(suspect=1))
    assert change.fails and "1 pixel equal, now suspect: (99, 99) equal -> suspect" in change.text


@pytest.mark.parametrize("kind", ["wrong", "suspect"])
@pytest.mark.parametrize(
    ("before", "after", "here", "elsewhere"),
    [(400, 401, True, False), (400, 455, True, False), (400, 461, True, True), (0, 1, True, True)],
)
def test_a_known_defect_may_grow_by_chance_on_another_processor_only(
    kind: str, before: int, after: int, here: bool, elsewhere: bool
) -> None:
    """By 2 √(then + now); one that was not there at all may not, nor may any where it was made."""
    then, now = classes(**{kind: before}), classes(**{kind: after})
    assert [c.fails for c in found(then, now)] == [here]
    assert [c.fails for c in found(then, now, same_processor=False)] == [elsewhere]


def test_a_defect_that_moved_fails_on_the_same_processor() -> None:
    """As many pixels are wrong as before, but not the same ones."""
    then, now = classes(), classes()
    then[5, 5:15], now[6, 5:15] = Class.WRONG, Class.WRONG
    assert any(c.fails for c in found(then, now))
    assert not any(c.fails for c in found(then, now, same_processor=False))


def test_a_defect_that_shrinks_is_noted() -> None:
    """Whether it is gone is the verdict's matter."""
    (change,) = found(classes(wrong=10), classes(wrong=3))
    assert not change.fails and change.text.startswith("7 pixels no longer wrong")


@pytest.mark.parametrize(
    ("then", "now", "fails"),
    [(0, 16, False), (0, 30, True), (1000, 1100, False), (1000, 1200, True), (1000, 0, True)],
)
def test_a_count_moves_as_far_as_chance_does(then: int, now: int, fails: bool) -> None:
    """Up to 4 + 4 √(then + now) is noted; beyond, another explanation is at work."""
    changed = [c.fails for c in found(classes(rounding=then), classes(rounding=now))]
    assert changed == [fails]


def test_an_explanation_that_no_longer_holds_says_what_came_instead() -> None:
    """All of one class go over to wrong."""
    changes = found(classes(model=2000), classes(wrong=2000))
    texts = [c.text for c in changes if c.fails]
    assert "model 2,000 -> 0, now 2,000 wrong" in texts
    assert any(text.startswith("2,000 pixels now wrong: (80, 0) model -> wrong") for text in texts)
