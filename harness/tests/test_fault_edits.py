"""What the edits do: to scenes, to texts, to images, and how much of that is counted."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from fault_examples import OPTIONS, honest, need, small
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from crosstrace.harness import tasks
from crosstrace.harness.faults import changed_pixels, image_operations, noise, scene_edits
from crosstrace.harness.faults import document_edits as document
from crosstrace.harness.faults import sdl_edits as sdl
from crosstrace.harness.faults.broken import broken_povray
from crosstrace.harness.lanes import loaded
from crosstrace.translators.effects import effects
from crosstrace.translators.mitsuba.document import double, single
from crosstrace.translators.mitsuba.elements import to_xml
from crosstrace.translators.povray.picture import analyse
from crosstrace.translators.renderer import Rendering, Seconds
from crosstrace.translators.scene import ETA, N, Scene, plane, sphere

IMAGES = arrays(
    np.float64, st.tuples(st.integers(1, 5), st.integers(1, 6), st.just(3)),
    elements=st.floats(0, 8),
)  # fmt: skip

SCENES = st.sampled_from(["polonia", "japao", "terra", "venn", "espelho2", "vidro4", "bolha2"])

EDITS: list[Callable[[Scene], Scene | None]] = [
    scene_edits.without_an_object, scene_edits.without_a_light, scene_edits.light_moved,
    scene_edits.one_bounce_fewer, scene_edits.one_bounce_more, scene_edits.planes_turned,
    scene_edits.indices_inverted, scene_edits.indices_off, scene_edits.diffuse_off,
    scene_edits.exponents_off, scene_edits.radii_off, scene_edits.quarter_turn,
    scene_edits.half_pixel_turn,
]  # fmt: skip


@settings(max_examples=40, deadline=None)
@given(name=SCENES, edit=st.sampled_from(EDITS))
def test_a_scene_edit_makes_another_valid_scene_of_the_same_size(
    name: str, edit: Callable[[Scene], Scene | None]
) -> None:
    """The result differs, was checked, keeps the picture's size, and the scene itself stays."""
    scene = small(name, 12, 16)
    sha256 = scene.sha256
    made = edit(scene)
    assert scene.sha256 == sha256
    if made is not None and made != scene:
        assert made.shape == scene.shape
        assert made.checked
        assert made.sha256 != sha256


def test_turning_planes_twice_gives_the_scene_back() -> None:
    """The negative of a negative is the number itself, to the last bit."""
    scene = small("espelho2")
    once = scene_edits.planes_turned(scene)
    assert once is not None
    assert once != scene
    assert scene_edits.planes_turned(once) == scene


def test_an_index_is_inverted_where_a_ray_goes_through_and_nowhere_else() -> None:
    """Opaque objects keep their n."""
    scene = small("vidro4")
    made = scene_edits.indices_inverted(scene)
    assert made is not None
    clear = scene.material[:, 5] > 0
    assert np.array_equal(made.material[clear, N], 1 / scene.material[clear, N])
    assert np.array_equal(made.material[~clear], scene.material[~clear])


def test_only_highlights_get_another_exponent() -> None:
    """An object without a specular term has none to be wrong about."""
    scene = small("vidro4")
    made = scene_edits.exponents_off(scene)
    assert made is not None
    shiny = scene.material[:, 2] > 0
    assert np.array_equal(made.material[:, ETA] - scene.material[:, ETA], shiny)


def test_two_quarter_turns_turn_the_picture_upside_down() -> None:
    """u and v both change their sign."""
    twice = scene_edits.quarter_turn(scene_edits.quarter_turn(small("bolha4")))
    made = tasks.render("native", twice, OPTIONS)[0].image
    assert np.abs(made[::-1, ::-1] - honest("native", "bolha4").image).max() < 1e-9


def test_the_object_that_goes_missing_is_a_small_one_that_can_be_seen() -> None:
    """Neither the ground that fills the picture, nor a speck, nor what hides behind another."""
    scene = Scene.build(
        delivery=1, v_res=60, h_res=80, pixel_size=0.02, screen_distance=1.0,
        eye=[0, 0, 10], target=[0, 0, 0], up=[0, 1, 0], background=[0, 0, 0],
        objects=[
            plane([1, 2, 3], [0, 0, -5], [0, 0, 1]),
            sphere([9, 9, 9], [0, 0, 0], 3.0),
            sphere([8, 8, 8], [4, 0, 0], 1.0),
            sphere([7, 7, 7], [0, 0, -2], 0.5),
            sphere([6, 6, 6], [-4, 0, 0], 0.1),
        ],
    )  # fmt: skip
    assert scene_edits.seen_object(scene) == 2
    made = scene_edits.without_an_object(scene)
    assert made is not None
    assert np.array_equal(made.color, scene.color[[0, 1, 3, 4]])


def test_where_only_specks_are_seen_the_largest_goes_missing() -> None:
    """An empty picture has no object to lose."""
    scene = small("olho")
    speck = replace(
        scene, checked=False, kind=scene.kind[:0], color=scene.color[:0],
        material=scene.material[:0], geometry=scene.geometry[:0],
    )  # fmt: skip
    assert scene_edits.seen_object(speck) is None
    specks = Scene.build(
        delivery=1, v_res=60, h_res=80, pixel_size=0.02, screen_distance=1.0,
        eye=[0, 0, 10], target=[0, 0, 0], up=[0, 1, 0], background=[0, 0, 0],
        objects=[sphere([9, 9, 9], [0, 0, 0], 0.1), sphere([8, 8, 8], [4, 0, 0], 0.2)],
    )  # fmt: skip
    assert scene_edits.seen_object(specks) == 1


@pytest.mark.parametrize(
    ("edit", "scene"),
    [
        (sdl.without_shadows, "venn"),
        (sdl.without_shadow_twins, "vidro4"),
        (sdl.filtered_shadows, "vidro4"),
        (sdl.one_level_fewer, "espelho2"),
        (sdl.default_bailout, "espelho2"),
        (sdl.indices_as_given, "nested-glass"),
        (sdl.exponents_off, "venn"),
        (sdl.without_the_last_object, "vidro4"),
        (sdl.decoded_gamma, "olho"),
        (sdl.mirrored, "olho"),
        (sdl.axes_swapped, "olho"),
        (sdl.half_pixel_right, "olho"),
    ],
)
def test_an_edit_finds_its_place_in_the_description(
    edit: Callable[[Scene, str], str], scene: str
) -> None:
    """The text changes, and braces still match."""
    text = analyse(small(scene)).text(1.0)
    wrong = edit(small(scene), text)
    assert wrong != text
    assert wrong.count("{") == wrong.count("}")


def test_the_description_loses_its_last_object_with_twin_and_light_group() -> None:
    """What stays is as it was, of as many objects as the scene has without that one."""
    for name in ("vidro4", "venn", "light-in-glass"):
        scene = small(name)
        last = np.arange(len(scene)) != len(scene) - 1
        shorter = replace(
            scene, checked=False, kind=scene.kind[last], color=scene.color[last],
            material=scene.material[last], geometry=scene.geometry[last],
        )  # fmt: skip
        text = analyse(scene).text(1.0)
        wrong = sdl.without_the_last_object(scene, text)
        assert text.startswith(wrong.removesuffix("\n"))
        expected, found = (
            [line for line in it.splitlines() if "texture" in line or "no_image" in line]
            for it in (analyse(shorter).text(1.0), wrong)
        )
        assert len(found) == len(expected)
        assert wrong.count("light_group {") == wrong.count("global_lights off }")


def test_indices_stay_as_they_are_where_nothing_is_nested() -> None:
    """Seen from outside, an object's absolute index is its n."""
    text = analyse(small("vidro4")).text(1.0)
    assert sdl.indices_as_given(small("vidro4"), text) == text


def test_two_half_pixels_of_povray_s_camera_are_one_column() -> None:
    """The picture moves to the right by exactly that."""
    need("povray")

    def whole(scene: Scene, text: str) -> str:
        return sdl.half_pixel_right(scene, sdl.half_pixel_right(scene, text))

    before = honest("povray", "venn")
    made = broken_povray(whole).render(small("venn"), OPTIONS)
    apart = np.abs(made.image[:, 1:] - before.image[:, :-1]).max(axis=2)
    # An edge may fall to the other side of a ray that is rounded otherwise.
    assert (apart > noise("povray", before, made)).sum() <= 2


@pytest.mark.parametrize("write", [single, double])
def test_a_document_is_edited_as_a_copy(write: Callable[..., document.Document]) -> None:
    """The honest one keeps its XML; the other one's differs."""
    scene = small("vidro4")
    before = write(scene, effects(scene).names)
    text = to_xml(before, "")
    for edit in (
        document.one_bounce_fewer, document.without_total_reflection, document.without_a_light,
        document.without_the_last_object, document.radii_off,
    ):  # fmt: skip
        assert to_xml(edit(before), "") != text, edit.__name__
        assert to_xml(before, "") == text
    assert (to_xml(document.normals_turned(before), "") != text) == (write is single)


@given(IMAGES)
def test_mirroring_twice_gives_the_image_back(image: np.ndarray) -> None:
    """To the last bit; once swaps the first and the last column."""
    once = image_operations.mirrored(image)
    assert np.array_equal(once[:, 0], image[:, -1])
    assert np.array_equal(image_operations.mirrored(once), image)


@given(IMAGES)
def test_image_operations_keep_shape_and_original(image: np.ndarray) -> None:
    """A new array of the same shape; what was given is not written to."""
    kept = image.copy()
    for operate in (
        image_operations.brighter, image_operations.mirrored, image_operations.clamped,
        image_operations.half_pixel_right, image_operations.srgb,
    ):  # fmt: skip
        made = operate(image)
        assert made.shape == image.shape
        assert not np.shares_memory(made, image)
    assert np.array_equal(image, kept)


@given(IMAGES)
def test_clamping_is_idempotent_and_touches_nothing_within_one(image: np.ndarray) -> None:
    """Values of 0…1 stay, what is beyond becomes 1."""
    once = image_operations.clamped(image)
    assert np.array_equal(image_operations.clamped(once), once)
    assert np.array_equal(once == image, image <= 1)


@given(IMAGES)
def test_half_a_pixel_moves_no_colour_out_of_its_range(image: np.ndarray) -> None:
    """An average lies between its terms, and one colour stays one colour."""
    made = image_operations.half_pixel_right(image)
    assert made.max() <= image.max()
    assert made.min() >= image.min()
    flat = np.full_like(image, image.flat[0])
    assert np.array_equal(image_operations.half_pixel_right(flat), flat)


@given(st.lists(st.floats(0, 4), min_size=2, max_size=20))
def test_the_screen_s_curve_rises_and_keeps_black_and_white(values: list[float]) -> None:
    """It is continuous where its two pieces meet."""
    row = np.sort(np.array(values))[None, :, None] * np.ones(3)
    assert (np.diff(image_operations.srgb(row), axis=1) >= 0).all()
    ends = image_operations.srgb(np.array([[[0.0, 1.0, 0.0031308]]]))[0, 0]
    assert ends == pytest.approx([0.0, 1.0, 12.92 * 0.0031308], abs=1e-7)
    beyond = image_operations.srgb(np.array([[[0.0031309, 0.0, 0.0]]]))[0, 0, 0]
    assert beyond == pytest.approx(12.92 * 0.0031309, abs=1e-6)


def _made(image: np.ndarray, half_step: float = 0.0, precision: str = "f64") -> Rendering:
    return Rendering(image, Seconds(), half_step, {"precision": precision})


def test_what_a_lane_s_own_noise_explains_is_not_counted() -> None:
    """Each lane has its arithmetic and its output; beyond 1 noise grows with the value."""
    image = np.full((2, 3, 3), 0.5)
    a, b = image.copy(), image.copy()
    b[0, 0, 1] += 5e-6
    b[1, 2, 0] += 3e-5
    assert changed_pixels("native", _made(a), _made(b)) == 2
    assert changed_pixels("native", _made(a, precision="f32"), _made(b, precision="f32")) == 1
    assert changed_pixels("mitsuba", _made(a), _made(b)) == 1
    assert changed_pixels("povray", _made(a, 7.6e-6), _made(b, 7.6e-6)) == 1
    assert changed_pixels("povray", _made(a, 1.6e-5), _made(b, 1.6e-5)) == 0
    assert changed_pixels("mitsuba", _made(1000 * a), _made(1000 * a + 3e-5)) == 0


def test_what_is_not_a_number_counts_where_only_one_image_has_it() -> None:
    """So does what is not finite; the same gap in both is no change."""
    image = np.full((2, 3, 3), 0.5)
    gap, burst = image.copy(), image.copy()
    gap[0, 0, 0], burst[1, 1] = np.nan, np.inf
    assert changed_pixels("native", _made(image), _made(gap)) == 1
    assert changed_pixels("native", _made(gap), _made(image)) == 1
    assert changed_pixels("native", _made(gap), _made(gap)) == 0
    assert changed_pixels("native", _made(image), _made(burst)) == 1
    assert changed_pixels("native", _made(burst), _made(image)) == 1


def test_the_honest_lanes_do_not_change_by_being_broken_before() -> None:
    """A broken renderer is an object of its own."""
    need("povray")
    before = loaded("povray").translate(small("venn"), OPTIONS)
    broken = broken_povray(sdl.mirrored).translate(small("venn"), OPTIONS)
    assert broken.files != before.files
    assert loaded("povray").translate(small("venn"), OPTIONS) == before
