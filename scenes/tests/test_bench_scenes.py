"""The packaged scenes to measure with: found by name, and in no suite."""

from __future__ import annotations

from crosstrace.harness.sources import all_packaged_names, bench_names, find, find_one
from crosstrace.translators.effects import EFFECTS, effects


def test_they_are_found_by_name_and_belong_to_no_suite() -> None:
    """A name alone finds each; neither a run without words nor a check takes them."""
    assert bench_names() == ("glass-bench", "phong-bench")
    assert not set(bench_names()) & set(all_packaged_names())
    assert not set(bench_names()) & {source.name for source in find()}
    for name in bench_names():
        source = find_one(name)
        assert source.title and source.about.endswith(".") and not source.packaged


def test_they_are_what_they_are_measured_for() -> None:
    """Glass calls for every effect of its delivery on four objects, Phong for no secondary ray."""
    glass, phong = (find_one(name).scene for name in bench_names())
    assert (len(glass), glass.max_depth) == (4, 4)
    assert set(effects(glass).names) == set(EFFECTS) - {"flat"}
    assert len(phong) == 3
    assert effects(phong).names == ("ambient", "diffuse", "specular", "shadows")
