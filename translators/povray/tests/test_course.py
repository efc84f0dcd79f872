"""On the course's own scenes POV-Ray keeps to native at the full size."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from crosstrace.translators.course import load
from crosstrace.translators.renderer import Rendering
from crosstrace.translators.scene import Scene

#: Nested glass at depth 2, and three lights; the others take longer than they tell here.
NAMES = ("bolha2", "venn")
OTHERS = ("espelho0", "espelho2", "japao", "olho", "piramide", "terra", "vidro4")


@pytest.mark.parametrize(
    "name", [*NAMES, *(pytest.param(name, marks=pytest.mark.slow) for name in OTHERS)]
)
def test_no_pixel_of_a_course_scene_departs(
    name: str, official: Path, beyond: Callable[[Scene], tuple[int, Rendering]]
) -> None:
    """Every pixel is within 7.63e-6·K + 1e-5 of native, at 480×640 too."""
    scene = load(official / f"{name}.txt")
    pixels, _ = beyond(scene)
    assert pixels == 0
