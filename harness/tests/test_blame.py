"""Who is blamed: lanes for impossible pixels, the reference where witnesses stand against it."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pytest

from crosstrace.harness import blame
from crosstrace.harness.classes import Class, Classified

SHAPE = (40, 50)
PLUGINS = {"shading": "plugins", "recursion": "plugins"}


def stated(
    lane: str, value: float = 0.5, stages: Mapping[str, str] | None = None, **counts: int
) -> blame.Testimony:
    """Return a lane whose first pixels are of the classes counted, the rest equal."""
    classes = np.zeros(SHAPE, np.uint8)
    at = 0
    for name, count in counts.items():
        classes.reshape(-1)[at : at + count] = Class[name.upper()]
        at += count
    image = np.full((*SHAPE, 3), value)
    classified = Classified(classes, np.full(SHAPE, 1e-6), 1e-6)
    return blame.Testimony(lane, image, classified, stages or {})


def judged(*lanes: blame.Testimony, violations: int = 0, like: bool = True) -> blame.Verdict:
    return blame.judge(lanes, "native", violations, like)


def test_all_equal_is_agreement_and_anything_else_without_fault_is_explained() -> None:
    """One pixel that took an explanation makes the difference."""
    assert judged(stated("native"), stated("b")).word == "agree"
    for kind in ("rounding", "undecidable", "model", "suspect"):
        found = judged(stated("native"), stated("b", **{kind: 1}))
        assert (found.word, found.blame) == ("explained", ())


def test_one_wrong_pixel_is_a_disagreement_with_the_lane_named() -> None:
    """The worst comes first, and the innocent are not named."""
    found = judged(stated("native"), stated("b", wrong=1), stated("c", wrong=9),
                   stated("d"))  # fmt: skip
    assert (found.word, found.blame) == ("disagree", ("c", "b"))


def test_suspect_pixels_are_tolerated_up_to_the_cap() -> None:
    """Eight in a small image, one in ten thousand of a large one."""
    assert judged(stated("native"), stated("b", suspect=8)).word == "explained"
    assert judged(stated("native"), stated("b", suspect=9)).blame == ("b",)
    assert blame.suspects_allowed(307_200) == 30


def test_too_many_undecidable_pixels_are_no_agreement_and_nobodys_fault() -> None:
    """Five in a hundred are allowed."""
    allowed = int(0.05 * SHAPE[0] * SHAPE[1])
    assert judged(stated("native"), stated("b", undecidable=allowed)).word == "explained"
    found = judged(stated("native"), stated("b", undecidable=allowed + 1))
    assert (found.word, found.blame) == ("disagree", ())


def test_a_reference_that_leaves_its_own_enclosure_is_broken() -> None:
    """By its own image, or by float128."""
    for found in (
        judged(stated("native", wrong=1), stated("b")),
        judged(stated("native"), stated("b"), violations=1),
    ):
        assert (found.word, found.blame) == ("reference-broken", ("native",))


def test_independent_lanes_that_agree_against_the_truth_break_the_reference() -> None:
    """Two that share no code and have one impossible value outweigh it."""
    found = judged(stated("native"), stated("b", wrong=50), stated("c", wrong=50))
    assert (found.word, found.blame, found.against) == ("reference-broken", ("native",), 50)


def test_lanes_that_are_wrong_in_different_ways_are_two_faults() -> None:
    """Agreement is of values, not of being wrong."""
    found = judged(stated("native"), stated("b", wrong=50),
                   stated("c", value=0.6, wrong=50))  # fmt: skip
    assert (found.word, set(found.blame)) == ("disagree", {"b", "c"})


@pytest.mark.parametrize("shared", ["intersection", "shading", "recursion"])
def test_lanes_that_share_code_are_one_witness(shared: str) -> None:
    """The two do the same thing wrong, which says nothing against the reference."""
    stages = {shared: "plugins"}
    found = judged(stated("native"), stated("b", stages=stages, wrong=50),
                   stated("c", stages=stages, wrong=50))  # fmt: skip
    assert (found.word, set(found.blame), found.against) == ("disagree", {"b", "c"}, 0)


def test_under_another_reading_the_others_cannot_speak_against_the_reference() -> None:
    """They were asked for the default, so their agreement is no evidence."""
    lanes = stated("native"), stated("b", wrong=50), stated("c", wrong=50)
    assert judged(*lanes, like=False).word == "disagree"


def test_the_table_says_whose_code_does_each_stage() -> None:
    """A lane does what it does not share."""
    table = blame.table([stated("a", stages=PLUGINS), stated("b")])
    assert table["shading"] == {"a": "plugins", "b": "b"}
    assert table["intersection"] == {"a": "a", "b": "b"}
