"""Counts of differences between fixed edges, and what they say about a tolerance."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from crosstrace.harness.spread import EDGES, TEXTS, quantile, spread


def above(counted: dict[str, Any], tolerance: float) -> int:
    """Count as the page's script does."""
    inside = sum(int(n) for text, n in counted["counts"].items() if float(text) > tolerance)
    return inside + int(counted["beyond"])


numbers = st.one_of(
    st.floats(0, 1e4), st.sampled_from(EDGES), st.just(0.0), st.just(np.nan), st.just(np.inf)
)


@given(values=st.lists(numbers, max_size=40))
def test_every_value_is_counted_once_and_edges_count_exactly(values: list[float]) -> None:
    """At each edge the count of what lies above is that of the values themselves."""
    array = np.array(values, np.float64)
    counted = spread(array)
    total = counted["none"] + sum(counted["counts"].values()) + counted["beyond"]
    assert total == len(values)
    for edge in (0.0, *EDGES):
        assert above(counted, edge) == sum(not value <= edge for value in values)


def test_edges_are_what_their_texts_say() -> None:
    """A tolerance that is copied from the page is the number that was counted by."""
    assert [float(text) for text in TEXTS] == list(EDGES)
    assert list(EDGES) == sorted(EDGES)
    assert (EDGES[0], EDGES[-1]) == (1e-16, 1e3)


@pytest.mark.parametrize(("worse", "expected"), [(0, 1.0), (1, 1.0), (2, 7.0)])
def test_of_1000_pixels_one_may_be_worse_than_p999(worse: int, expected: float) -> None:
    """The 99.9th percentile is a value that occurs."""
    values = np.ones(1000)
    values[:worse] = 7.0
    assert quantile(values) == expected


def test_a_quantile_counts_nan_as_the_worst() -> None:
    """Nothing undefined is left out."""
    assert quantile(np.array([np.nan, 1.0])) == np.inf
    assert quantile(np.array([])) == 0.0
