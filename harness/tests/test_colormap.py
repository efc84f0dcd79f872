"""Pictures of differences: fixed scales, and colours that can be told apart by anyone."""

from __future__ import annotations

import numpy as np
import pytest

from crosstrace.harness import colormap


def _luminance(colors: np.ndarray) -> np.ndarray:
    """CIE luminance of 8-bit sRGB."""
    v = colors / 255
    linear = np.where(v <= 0.04045, v / 12.92, ((v + 0.055) / 1.055) ** 2.4)
    luminance: np.ndarray = linear @ np.array([0.2126, 0.7152, 0.0722])
    return luminance


def test_the_ramp_grows_lighter_all_the_way() -> None:
    """So it reads the same in grey and without colour vision, and never doubles back."""
    lightness = np.cbrt(_luminance(colormap.ramp(np.linspace(0, 1, 64))))
    steps = np.diff(lightness)
    assert (steps > 0).all()
    assert steps.max() < 4 * steps.mean()


def test_the_same_difference_has_the_same_colour_in_every_picture() -> None:
    """The scale is fixed, not fitted to the picture's greatest value."""
    small = colormap.difference_picture(np.array([[1e-6, 0.0]]))
    large = colormap.difference_picture(np.array([[1e-6, 1.0]]))
    assert (small[0, 0] == large[0, 0]).all()


def test_differences_are_drawn_by_decades_between_the_ends() -> None:
    """1e-9 is the first colour and 1 the last; a tenth moves by a ninth of the ramp."""
    picture = colormap.difference_picture(np.array([[1e-12, 1e-9, 1e-6, 1.0, 50.0]]))[0]
    expected = colormap.ramp(np.array([0.0, 0.0, 1 / 3, 1.0, 1.0]))
    assert np.array_equal(picture, expected)


def test_no_difference_and_no_number_have_colours_of_their_own() -> None:
    """Black and magenta are not on the ramp."""
    picture = colormap.difference_picture(np.array([[0.0, np.nan, np.inf]]))[0].tolist()
    assert picture[:2] == [list(colormap.NOTHING), list(colormap.NOT_A_NUMBER)]
    assert picture[2] == list(colormap.STOPS[-1])
    on_ramp = colormap.ramp(np.linspace(0, 1, 256)).tolist()
    assert list(colormap.NOTHING) not in on_ramp
    assert list(colormap.NOT_A_NUMBER) not in on_ramp


@pytest.mark.parametrize("ticks", [colormap.difference_ticks(), colormap.similarity_ticks()])
def test_the_marks_of_a_colour_bar_stand_in_order_within_it(
    ticks: list[tuple[float, str]],
) -> None:
    """From its left end to its right."""
    positions = [position for position, _ in ticks]
    assert positions == sorted(positions)
    assert (positions[0], positions[-1]) == (0.0, 1.0)


@pytest.mark.parametrize(("position", "label"), colormap.difference_ticks())
def test_a_mark_of_the_difference_scale_has_the_colour_of_its_value(
    position: float, label: str
) -> None:
    """The legend is the picture's own scale."""
    value = 1 / 255 if label == "1/255" else float(label)
    drawn = colormap.difference_picture(np.array([[value]]))[0, 0]
    assert np.array_equal(drawn, colormap.ramp(np.array([position]))[0])


@pytest.mark.parametrize(("position", "label"), colormap.similarity_ticks())
def test_a_mark_of_the_similarity_scale_has_the_colour_of_its_value(
    position: float, label: str
) -> None:
    """Like is dark and unlike is light, as in the difference picture."""
    value = 0.0 if label == "≤ 0" else float(label)
    drawn = colormap.similarity_picture(np.full((1, 1, 3), value))[0, 0]
    beside = colormap.ramp(np.array([position]))[0]
    assert np.abs(drawn.astype(int) - beside).max() <= 1


def test_full_similarity_is_black() -> None:
    """Also where the window's sums leave a rounding."""
    full = np.array([[[1.0] * 3, [1 - 1e-12] * 3, [-0.5] * 3]])
    picture = colormap.similarity_picture(full)[0].tolist()
    assert picture == [list(colormap.NOTHING), list(colormap.NOTHING), list(colormap.STOPS[-1])]


def test_classes_are_read_back_from_their_picture() -> None:
    """To the last pixel; a picture of something else is refused."""
    classes = np.arange(12, dtype=np.uint8).reshape(3, 4) % len(colormap.CLASS_COLORS)
    picture = colormap.class_picture(classes)
    assert np.array_equal(colormap.classes_of_picture(picture), classes)
    picture[1, 2] += 1
    with pytest.raises(ValueError, match="no class"):
        colormap.classes_of_picture(picture)
