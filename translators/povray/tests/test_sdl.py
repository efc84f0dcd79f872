"""Each mechanism of the recipe is in the description where it is needed, and only there."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from crosstrace.translators.errors import UnsupportedSceneError
from crosstrace.translators.povray.picture import Analysis, analyse
from crosstrace.translators.scene import Scene, plane, sphere

Make = Callable[..., Scene]

FLOOR = plane([10, 20, 30], [0, 0, -2], [0, 0, 1], ka=0.1, kd=0.5, ks=0.2, eta=9)
SUN = ([200, 200, 200], [0, -3, 5])


def ball(center: list[float], radius: float = 1.0, **material: float) -> dict[str, Any]:
    stated = {"ka": 0.1, "kd": 0.5, "ks": 0.2, "eta": 9.0, **material}
    return sphere([51, 102, 255], center, radius, **stated)


def text(scene: Scene, requested: frozenset[str] | None = None) -> str:
    return analyse(scene, requested).text(1.0)


def test_only_numbers_and_keywords_are_written(make_scene: Make) -> None:
    """A scene's name and path, which may hold directives, never reach the description."""
    scene = make_scene(objects=[FLOOR, ball([0, 0, 0], kt=0.5, n=1.5)], lights=[SUN],
                       name='x";\n#fopen f "y" write', path="*/ #include")  # fmt: skip
    assert not re.search(r'"|fopen|include|//', text(scene))


def test_opaque_objects_cast_their_own_shadow(make_scene: Make) -> None:
    """No twin, no light group and no flag is written for an opaque scene seen from outside."""
    written = text(make_scene(objects=[FLOOR, ball([0, 0, 0])], lights=[SUN]))
    for word in (
        "no_shadow",
        "no_image",
        "inverse",
        "double_illuminate",
        "interior",
        "light_group",
    ):
        assert word not in written


def test_glass_has_a_twin_for_shadow_rays(make_scene: Make) -> None:
    """The visible twin casts no shadow; the black one is met by shadow rays alone."""
    written = text(make_scene(objects=[ball([0, 0, 0], kt=0.5, n=1.5)], lights=[SUN]))
    assert written.count("sphere {") == 2
    assert written.count(" no_shadow }") == 1
    assert written.count("pigment { rgb 0 } no_image no_reflection }") == 1


def test_transmission_is_exactly_kt(make_scene: Make) -> None:
    """Filter and transmit cancel, so that the surface's own light keeps its full weight."""
    written = text(make_scene(objects=[ball([0, 0, 0], kt=1.0, n=1.5)], lights=[SUN]))
    numbers = re.search(r"rgbft <(.*?)>", written)
    assert numbers is not None
    *color, filtered, transmitted = map(float, numbers[1].split(","))
    assert (filtered, transmitted) == (-1.0, 1.0)
    assert color[2] == 2.0**-30
    assert f"ambient {0.1 * 2.0**30!r} diffuse {0.5 * 2.0**30!r}" in written


@pytest.mark.parametrize(
    ("dropped", "word"),
    [("ambient", "ambient 0.1"), ("diffuse", "diffuse 0.5"), ("specular", "phong"),
     ("reflection", "reflection {"), ("shadows", "no_image")],
)  # fmt: skip
def test_an_effect_that_is_not_asked_for_is_not_written(
    make_scene: Make, dropped: str, word: str
) -> None:
    """Taking one effect away takes its words away."""
    scene = make_scene(
        objects=[plane([9, 9, 9], [0, 0, 0], [0, 0, 1], ka=0.1, kd=0.5, ks=0.2, kr=0.3),
                 plane([9, 9, 9], [0, 0, -1], [0, 0, 1], kt=0.3, n=1.2)],
        lights=[SUN],
    )  # fmt: skip
    everything = frozenset({"ambient", "diffuse", "specular", "shadows", "reflection",
                            "refraction", "total_reflection"})  # fmt: skip
    assert word in text(scene, everything)
    assert word not in text(scene, everything - {dropped})


def test_refraction_and_total_reflection_go_together(make_scene: Make) -> None:
    """POV-Ray cannot leave out one of them; asking for that is refused."""
    scene = make_scene(objects=[ball([0, 0, 0], kt=0.5, n=1.5)], lights=[SUN])
    with pytest.raises(UnsupportedSceneError, match="both or neither"):
        analyse(scene, frozenset({"refraction"}))


def test_highlights_and_diffuse_light_of_a_ball_need_shadows(make_scene: Make) -> None:
    """Without shadows POV-Ray cannot give the far half of a ball its highlight alone."""
    scene = make_scene(objects=[ball([0, 0, 0])], lights=[SUN])
    with pytest.raises(UnsupportedSceneError, match="leave out shadows"):
        analyse(scene, frozenset({"diffuse", "specular"}))


def test_no_lights_are_written_where_nothing_is_lit(make_scene: Make) -> None:
    """Objects with an ambient term alone leave the lights out."""
    written = text(make_scene(objects=[ball([0, 0, 0], kd=0.0, ks=0.0)], lights=[SUN]))
    assert "light_source" not in written


def test_an_object_that_holds_the_camera_is_inverted(make_scene: Make) -> None:
    """So no ray starts inside an interior; its inner side is lit as its outer."""
    written = text(make_scene(objects=[ball([0, 0, 0], 50.0)], lights=[SUN]))
    assert " inverse" in written


def indices(scene: Scene) -> list[float]:
    analysis: Analysis = analyse(scene)
    return [round(float(i), 5) for i in analysis.media.ior]


def test_nested_glass_gets_absolute_indices(make_scene: Make) -> None:
    """An index is the product of all n around, relative to the camera's region."""
    shells = [ball([0, 0, 0], 3.0, kt=0.5, n=1.5), ball([0, 0, 0], 2.0, kt=0.5, n=1.2),
              ball([0, 0, 0], 1.0, kt=0.5, n=0.5)]  # fmt: skip
    assert indices(make_scene(objects=shells, eye=[0, -9, 0])) == [1.5, 1.8, 0.9]
    # From the second shell: outwards the index falls, inwards it is relative to that shell.
    assert indices(make_scene(objects=shells, eye=[0, -1.5, 0])) == pytest.approx(
        [1 / 1.8, 1 / 1.2, 0.5], abs=1e-5
    )


def test_a_plane_of_glass_is_a_half_space(make_scene: Make) -> None:
    """What lies wholly behind the plane is inside it, what lies before it is not."""
    water = plane([9, 9, 9], [0, 0, -1], [0, 0, 2], kt=0.5, n=1.3)
    below, above = ball([0, 0, -3], kt=0.5, n=1.5), ball([0, 0, 1], kt=0.5, n=1.5)
    scene = make_scene(objects=[below, water, above])
    assert indices(scene) == pytest.approx([1.95, 1.3, 1.5], abs=1e-5)
    assert len(analyse(scene).media.crossing) == 0
    dipped = make_scene(objects=[ball([0, 0, -1.5], kt=0.5, n=1.5), water, above])
    assert analyse(dipped).media.crossing.tolist() == [0, 1]


def test_nesting_is_found_among_many_surfaces(make_scene: Make) -> None:
    """However many spheres stand along x, each bubble gets the index of its own shell."""
    shells = [ball([3.0 * i, 0, 0], 1.0, kt=0.5, n=1.5) for i in range(300)]
    bubbles = [ball([3.0 * i, 0, 0], 0.5, kt=0.5, n=2.0) for i in reversed(range(300))]
    scene = make_scene(objects=[*shells, *bubbles], eye=[0, -9, 0])
    assert indices(scene) == [1.5] * 300 + [3.0] * 300
    # From inside one shell all other surfaces stand behind its far side.
    scene = make_scene(objects=[*shells, *bubbles], eye=[30, -0.75, 0], target=[30, 9, 0])
    seen = np.array(indices(scene))
    assert seen[10] == pytest.approx(1 / 1.5, abs=1e-5)
    assert seen[300 + 289] == 2.0
    assert np.delete(seen, [10, 589]) == pytest.approx([1.0] * 299 + [2.0] * 299, abs=1e-5)


def test_n_of_1_is_one_float32_step_off(make_scene: Make) -> None:
    """POV-Ray would not count a surface that bends nothing as a bounce."""
    scene = make_scene(objects=[ball([0, 0, 0], kt=0.5, n=1.0)])
    assert analyse(scene).media.ior.tolist() == [float(np.nextafter(np.float32(1), np.float32(2)))]


def test_an_index_beyond_float32_is_refused(make_scene: Make) -> None:
    """Indices that float32 cannot multiply are an error, not an infinity."""
    with pytest.raises(UnsupportedSceneError, match="float32"):
        analyse(make_scene(objects=[ball([0, 0, 0], kt=0.5, n=1e30)]))


def test_lights_on_both_sides_make_a_light_group(make_scene: Make) -> None:
    """An inner light's diffuse term is taken away again by a pair of fill lights."""
    written = text(make_scene(objects=[FLOOR], lights=[SUN, ([9, 9, 9], [0, 0, -5])]))
    assert written.count("light_group") == 1
    assert written.count("shadowless") == 2
    assert written.count("projected_through { blockers }") == 1
    assert "global_lights off" in written


def test_a_matt_object_lit_from_both_sides_ignores_inner_lights(make_scene: Make) -> None:
    """Without a highlight an inner light adds nothing, so the group holds the outer ones."""
    matt = plane([10, 20, 30], [0, 0, -2], [0, 0, 1], kd=0.5)
    written = text(make_scene(objects=[matt], lights=[SUN, ([9, 9, 9], [0, 0, -5])]))
    group = written[written.index("light_group") :]
    assert group.count("light_source") == 1
    assert "shadowless" not in written


def test_inner_lights_alone_take_the_diffuse_term_away(make_scene: Make) -> None:
    """A plane lit from behind keeps its highlight only."""
    written = text(make_scene(objects=[FLOOR], lights=[([9, 9, 9], [0, 0, -5])]))
    assert "diffuse 0.0 phong 0.2" in written
    assert "double_illuminate" in written


def test_coincident_surfaces_are_written_once(make_scene: Make) -> None:
    """The first in the file hides the others, however the same plane is spelled."""
    again = plane([1, 1, 1], [5, 7, -2], [0, 0, -3], ka=1.0)
    analysis = analyse(make_scene(objects=[ball([0, 0, 0]), FLOOR, again, ball([0, 0, -0.0])]))
    assert analysis.plan.index.tolist() == [0, 1]


def test_the_trace_level_is_the_depth_and_one(make_scene: Make) -> None:
    """POV-Ray counts the primary ray as a level; without secondary rays the depth is no matter."""
    mirrors = make_scene(objects=[ball([0, 0, 0], kr=0.5)], max_depth=7)
    assert "max_trace_level 8\n" in text(mirrors)
    matt = make_scene(objects=[ball([0, 0, 0])], max_depth=10**6)
    assert "max_trace_level 1\n" in text(matt)


def test_faint_rays_are_dropped_only_beyond_the_greatest_depth(make_scene: Make) -> None:
    """POV-Ray traces 255 bounces; a scene that asks for more goes without what adds nothing."""
    mirror = ball([0, 0, 0], kr=0.8)
    assert "max_trace_level 256\n  adc_bailout 1e-10\n" in text(
        make_scene(objects=[mirror], max_depth=10**9)
    )
    assert "max_trace_level 256\n  adc_bailout 0\n" in text(
        make_scene(objects=[mirror], max_depth=255)
    )


def test_the_world_scale_is_a_power_of_two_that_keeps_far_things(make_scene: Make) -> None:
    """Scaling changes no digit, and nothing finite is pushed beyond POV-Ray's farthest hit."""
    for far in (1.0, 1e4, 1e7, 1e12):
        scale = analyse(make_scene(objects=[ball([0, far, 0])])).scale
        assert np.frexp(scale)[0] == 0.5
        assert scale * far <= 1e7


def test_no_pixel_exceeds_the_bound_of_a_white_room(make_scene: Make) -> None:
    """The bound counts every bounce: it grows with the depth, and is the background at least."""
    mirror = ball([0, 0, 0], kr=0.5)
    scenes = [make_scene(objects=[mirror], lights=[SUN], max_depth=d) for d in (0, 1, 5)]
    bounds = [analyse(scene).bound for scene in scenes]
    assert bounds == sorted(bounds)
    assert bounds[0] < bounds[1]
    assert analyse(make_scene(background=[255, 0, 0])).bound == 1.0
