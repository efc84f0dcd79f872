"""Samples of a pixel's area: where they are, and what their mean is."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from crosstrace.native import _core
from crosstrace.translators import sampling
from crosstrace.translators.errors import UsageError
from crosstrace.translators.native.adapter import Native
from crosstrace.translators.native.samples import refined
from crosstrace.translators.renderer import RenderOptions
from crosstrace.translators.sampling import CENTRE, Sampling, parse
from crosstrace.translators.scene import Scene, plane

MakeScene = Callable[..., Scene]


def horizon(columns: int = 3) -> Scene:
    """Return three rows of which the middle one sees as much of a white plane as of black sky."""
    return Scene.build(
        delivery=1, v_res=3, h_res=columns, pixel_size=0.01, screen_distance=1.0,
        eye=np.array([0.0, 0.0, 1.0]), target=np.array([0.0, 1.0, 1.0]),
        up=np.array([0.0, 0.0, 1.0]), background=np.zeros(3),
        objects=[plane((255, 255, 255), (0, 0, 0), (0, 0, 1))],
    )  # fmt: skip


def rendered(scene: Scene, how: str, **options: Any) -> np.ndarray[Any, np.dtype[np.float64]]:
    return Native().render(scene, RenderOptions(sampling=parse(how), **options)).image


def raw(scene: Scene, *settings: tuple[str, str]) -> np.ndarray[Any, np.dtype[np.float64]]:
    image = np.empty(scene.shape)
    _core.render(scene.native_view(), list(settings), {"image": image}, None)
    return image


@pytest.mark.parametrize(
    "how", ["regular:2", "regular:8", "jittered:2", "jittered:6", "adaptive:4"]
)
def test_an_area_half_covered_is_half_bright(how: str) -> None:
    """The horizon halves the middle row: closed form, whatever way an even number is spread."""
    image = rendered(horizon(), how)
    assert (image[0] == 0.0).all() and (image[2] == 1.0).all()
    assert (image[1] == 0.5).all()


def test_jittered_points_are_uniform_over_the_pixel() -> None:
    """Of single samples half lie below the horizon, within five standard deviations."""
    image = rendered(horizon(4000), "jittered:1")
    assert (image[0] == 0.0).all() and (image[2] == 1.0).all()
    assert abs(image[1].mean() - 0.5) < 5 * 0.5 / np.sqrt(4000)


def test_the_centre_is_the_specification(random_scene: MakeScene) -> None:
    """One regular sample is the pixel's centre, to the last bit."""
    scene = random_scene(5)
    assert np.array_equal(rendered(scene, "regular:1"), rendered(scene, "centre"))


def test_regular_samples_are_the_centres_of_a_finer_frame(random_scene: MakeScene) -> None:
    """Their mean is that of the frame at so many times the resolution."""
    scene = random_scene(3).resized(9, 11)
    fine = Native().render(scene.resized(27, 33), RenderOptions()).image
    means = fine.reshape(9, 3, 11, 3, 3).mean(axis=(1, 3))
    assert np.array_equal(rendered(scene, "regular:3"), means)


@pytest.mark.parametrize("precision", ["f32", "f64", "f64c", "dd"])
def test_jitter_is_the_same_by_any_way_of_tracing(precision: str, random_scene: MakeScene) -> None:
    """Threads and instruction sets leave every bit alone; another seed moves the samples."""
    scene = random_scene(8).resized(20, 37)
    settings = ("precision", precision), ("jitter", "7")
    first = raw(scene, *settings)
    for other in (("threads", "1"), ("instructions", "generic"), ("instructions", "scalar")):
        if other[1] in ("1", "generic", *_core.instructions()):
            assert np.array_equal(first, raw(scene, *settings, other))
    assert not np.array_equal(first, raw(scene, ("precision", precision), ("jitter", "8")))
    assert not np.array_equal(first, raw(scene, ("precision", precision)))


@pytest.mark.parametrize("precision", ["f32", "f64", "f64c"])
@pytest.mark.parametrize("side", [1, 3, 24])
def test_cells_have_the_bits_of_the_frame(
    precision: str, side: int, random_scene: MakeScene
) -> None:
    """Squares of a frame, in any order and repeated, are what the whole frame has there."""
    scene = random_scene(11).resized(2 * side, 5 * side)
    frame = raw(scene, ("precision", precision))
    squares = frame.reshape(2, side, 5, side, 3).swapaxes(1, 2).reshape(10, side, side, 3)
    cells = np.array([9, 0, 4, 4, 7], np.int64)
    image = np.empty((5, side, side, 3))
    rays = np.empty((5, side, side), np.uint32)
    counts = _core.render(scene.native_view(), [("precision", precision)],
                          {"image": image, "rays": rays}, None, None, cells, side)  # fmt: skip
    assert np.array_equal(image, squares[cells])
    kinds = ("primary", "shadow", "reflected", "refracted")
    assert sum(counts[kind] for kind in kinds) == rays.sum()


@pytest.mark.parametrize(("cells", "side"), [([10], 3), ([-1], 3), ([0], 4), ([0], 0), ([0], 65)])
def test_cells_that_are_not_there_are_refused(
    cells: list[int], side: int, random_scene: MakeScene
) -> None:
    """An index or a side that does not fit the frame is no call into nowhere."""
    scene = random_scene(11).resized(6, 15)
    image = np.empty((1, max(side, 0), max(side, 0), 3))
    with pytest.raises(ValueError):
        _core.render(scene.native_view(), [], {"image": image}, None, None, np.array(cells), side)


def test_truth_is_that_of_the_centre() -> None:
    """Certification refuses jitter instead of certifying another ray."""
    scene = horizon()
    outputs = {"lo": np.empty(scene.shape), "hi": np.empty(scene.shape)}
    with pytest.raises(RuntimeError):
        _core.certify(scene.native_view(), [("jitter", "1")], None, 1e-9, 0.0, outputs, None)


def test_adaptive_is_close_where_something_differs_and_coarse_elsewhere(
    random_scene: MakeScene,
) -> None:
    """Every pixel is the mean of all samples or of four, and both occur."""
    scene = random_scene(2).resized(24, 32)
    image = rendered(scene, "adaptive:6")
    close = (image == rendered(scene, "regular:6")).all(axis=-1)
    coarse = (image == rendered(scene, "regular:2")).all(axis=-1)
    assert (close | coarse).all()
    assert (close & ~coarse).any() and (coarse & ~close).any()


def test_a_differing_sample_refines_its_pixel_and_the_neighbours() -> None:
    """By the ray tree alone, and by the colour alone."""
    trees, colors = np.zeros((8, 8), np.uint64), np.zeros((8, 8, 3))
    assert not refined(trees, colors).any()
    trees[2, 2] = 1
    expected = np.zeros((4, 4), np.bool_)
    expected[1, 1] = expected[0, 1] = expected[1, 0] = True
    assert np.array_equal(refined(trees, colors), expected)
    trees[2, 2], colors[2, 2, 1] = 0, 0.03
    assert np.array_equal(refined(trees, colors), expected)
    colors[2, 2, 1] = 0.01
    assert not refined(trees, colors).any()


def test_the_text_of_a_sampling_reads_back() -> None:
    """`str` and `parse` are inverse."""
    for how in (
        CENTRE,
        Sampling("regular", 4),
        Sampling("jittered", 3, 9),
        Sampling("adaptive", 64),
    ):
        assert parse(str(how)) == how


@pytest.mark.parametrize(
    "text", ["", "regular", "regular:0", "regular:65", "regular:2:3", "jittered:2:0", "random:4",
             "regular:-1", "regular:²", "adaptive:1e1", "centre:1"],
)  # fmt: skip
def test_a_sampling_that_is_none_is_refused(text: str) -> None:
    """The message says what is expected."""
    with pytest.raises(UsageError, match=re.escape("expected centre, regular:K")):
        parse(text)


def test_side_outputs_and_foreign_settings_are_refused() -> None:
    """They are a centre's, and another renderer's: nothing is ignored in silence."""
    options = RenderOptions(sampling=Sampling("regular", 2), layers=True)
    with pytest.raises(UsageError, match="centre"):
        Native().render(horizon(), options)
    with pytest.raises(UsageError, match="readings alone"):
        Native().render(horizon(), replace(options, sampling=CENTRE, tuning={"antialias": "0"}))
    with pytest.raises(UsageError, match="one ray a pixel"):
        sampling.only_centre(Sampling("jittered", 2), "mitsuba")
