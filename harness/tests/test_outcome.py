"""What a verdict means for the exit status, and how it is said."""

from __future__ import annotations

from typing import Any

import pytest

from crosstrace.harness import outcome
from crosstrace.harness.classes import NAMES

EXPECTED = {"verdict": "disagree", "blame": ["b"], "cause": "float32 spheres lose their digits"}


def lane(name: str, regions: list[dict[str, Any]] | None = None, **counts: int) -> dict[str, Any]:
    classes = {**dict.fromkeys(NAMES, 0), "equal": 100, **counts}
    found = regions or []
    return {
        "name": name,
        "classes": classes,
        "regions": found,
        "n_regions": len(found),
        "declared": [],
    }


def scene(verdict: str, *lanes: dict[str, Any], **more: Any) -> dict[str, Any]:
    plain = {"verdict": verdict, "blame": [], "expected": None, "renderers": list(lanes),
             "judgement": {"message": "", "agreed_against_reference": 0,
                           "truth": {"float128_outside": 0}}}  # fmt: skip
    return {**plain, **more}


@pytest.mark.parametrize(
    ("verdicts", "status"),
    [
        (["agree", "explained"], 0),
        (["agree", "disagree"], 1),
        (["reference-broken"], 1),
        (["agree", "incomplete"], 3),
        (["incomplete", "disagree"], 1),
        ([], 0),
    ],
)
def test_the_exit_status_is_the_worst_scenes(verdicts: list[str], status: int) -> None:
    """A disagreement wins over a missing renderer."""
    assert outcome.exit_status({"scenes": [scene(word, lane("a")) for word in verdicts]}) == status


def test_a_known_defect_is_fine_exactly_as_expected() -> None:
    """A departure either way is not: another lane, nobody, or another verdict."""
    lanes = lane("a"), lane("b", wrong=3)
    cases = {("disagree", ("b",)): "fine", ("disagree", ("a",)): "departs",
             ("disagree", ("a", "b")): "departs", ("explained", ()): "departs",
             ("reference-broken", ("b",)): "departs", ("incomplete", ()): "incomplete"}  # fmt: skip
    for (word, blamed), expected in cases.items():
        found = scene(word, *lanes, blame=list(blamed), expected=EXPECTED)
        assert outcome.outcome(found) == expected, (word, blamed)


def test_an_expectation_of_a_lane_that_is_not_there_says_nothing() -> None:
    """The others still have to agree."""
    assert outcome.outcome(scene("explained", lane("a"), expected=EXPECTED)) == "fine"


def test_the_sentence_names_who_agrees_and_who_is_wrong_and_where() -> None:
    """With the largest region, the count of others, and what the index expects."""
    region = {"kind": "blob", "where": "the silhouette of object 3"}
    found = scene("disagree", lane("a", rounding=4), lane("b", [region] * 3, wrong=41),
                  blame=["b"], expected=EXPECTED)  # fmt: skip
    said = outcome.sentence(found)
    assert said.startswith("a agrees with the truth everywhere. ")
    assert "a: 4 within rounding" in said
    assert "b: wrong on 41 pixels (a blob on the silhouette of object 3 and 2 other places)" in said
    assert "As expected: disagree; float32 spheres lose their digits." in said


def test_a_broken_reference_says_what_speaks_against_it() -> None:
    """Float128, or the agreement of the others."""
    judgement = {"message": "", "agreed_against_reference": 17, "truth": {"float128_outside": 0}}
    found = scene("reference-broken", lane("native"), blame=["native"], judgement=judgement)
    assert "agree with each other against it in 17 pixels" in outcome.sentence(found)
    judgement["truth"]["float128_outside"] = 2
    assert "float128 leaves its own enclosure in 2 pixels" in outcome.sentence(found)
