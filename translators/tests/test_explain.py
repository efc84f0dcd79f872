"""Ray trees: the bits of a rendering, terms that add up, and what is refused."""

from __future__ import annotations

import math
from collections.abc import Callable
from importlib.resources import as_file, files

import numpy as np
import pytest

from crosstrace.translators.course import load, parse
from crosstrace.translators.errors import RendererError, UsageError
from crosstrace.translators.native.explain import RayKind, explain
from crosstrace.translators.native.truth import Decision, certify
from crosstrace.translators.registry import renderer
from crosstrace.translators.renderer import Rendering, RenderOptions
from crosstrace.translators.scene import Scene

GLASS = (
    "30 40 0.04 1 0 -6 1.5 0 0 0.8 0 0 1 120 170 230 5 5 "
    "220 220 220 0.2 0.7 0 1 0.2 0 1 / 0 0 0 0 0 1 "
    "230 60 60 0.1 0.7 0.4 50 0.1 0 1 * -1.1 1 1 1 "
    "30 30 30 0.0 0.1 0.5 200 0.1 0.8 1.5 * 0 -0.5 1 1 "
    "30 30 90 0.0 0.1 0.5 200 0 0.8 0.8 * 0.1 -0.5 1.1 0.4 "
    "60 60 230 0.1 0.7 0.4 20 0.6 0 1 * 1.3 1.2 1 1 "
    "255 255 255 2 150 150 150 -4 -5 6 120 120 120 3 -2 5"
)


def _rendered(scene: Scene, readings: dict[str, str] | None = None) -> Rendering:
    return renderer("native").render(scene, RenderOptions(readings=readings or {}, layers=True))


def _pixels(scene: Scene, count: int, seed: int) -> list[tuple[int, int]]:
    rng = np.random.default_rng(seed)
    rows, columns = rng.integers(scene.v_res, size=count), rng.integers(scene.h_res, size=count)
    return list(zip(rows.tolist(), columns.tolist(), strict=True))


@pytest.mark.parametrize("seed", range(40))
def test_a_tree_has_the_bits_of_the_rendering(
    random_scene: Callable[..., Scene], seed: int
) -> None:
    """Hash, colour, number of rays and first hit of random pixels of random scenes are equal."""
    scene = random_scene(seed, delivery=1 + seed % 3)
    made = _rendered(scene)
    for row, column in _pixels(scene, 25, seed):
        tree = explain(scene, row, column)
        assert tree.tree == made.layers["tree"][row, column]
        assert tree.color == tuple(made.image[row, column])
        assert len(tree.rays) == tree.n_rays == made.layers["rays"][row, column]
        first = tree.rays[0]
        assert (first.kind, first.parent, first.weight) == (RayKind.PRIMARY, -1, 1.0)
        assert (first.object, first.t_world) == (
            made.layers["object"][row, column], made.layers["t"][row, column]
        )  # fmt: skip
        assert np.array_equal(first.normal, made.layers["normal"][row, column])


def test_contributions_add_up_to_the_pixel() -> None:
    """On nested glass, what all rays add is the colour to 1e-12; shadow rays say where from."""
    scene = parse(GLASS)
    depths = set()
    for row, column in _pixels(scene, 200, 1):
        tree = explain(scene, row, column)
        rays = [ray for ray in tree.rays if ray.kind != RayKind.SHADOW]
        total = np.sum([ray.contribution for ray in rays], axis=0)
        np.testing.assert_allclose(total, tree.color, rtol=0, atol=1e-12)
        lights = np.sum(
            [np.multiply(ray.weight, ray.color) for ray in tree.rays
             if ray.kind == RayKind.SHADOW] or [np.zeros(3)], axis=0
        )  # fmt: skip
        local = [np.multiply(ray.weight, np.add(ray.diffuse, ray.specular)) for ray in rays]
        np.testing.assert_allclose(lights, np.sum(local, axis=0), rtol=0, atol=1e-12)
        depths |= {ray.depth for ray in tree.rays}
    assert depths == set(range(6))


def test_every_kind_of_ray_is_met_and_points_where_it_goes() -> None:
    """Directions are of length 1, and a hit lies at its distance along the ray."""
    scene = parse(GLASS)
    rays = [ray for row, column in _pixels(scene, 100, 2)
            for ray in explain(scene, row, column).rays]  # fmt: skip
    assert {ray.kind for ray in rays} == set(RayKind)
    for ray in rays:
        assert math.hypot(*ray.direction) == pytest.approx(1, abs=1e-14)
        if ray.object >= 0:
            there = np.add(ray.origin, np.multiply(ray.t_world, ray.direction))
            np.testing.assert_allclose(there, ray.point, rtol=0, atol=1e-12)
            assert math.hypot(*ray.normal) == pytest.approx(1, abs=1e-14)
        else:
            assert ray.t_world == math.inf


def test_an_undecidable_pixel_has_a_margin_of_rounding() -> None:
    """Where certification leaves the nearest hit open, the first ray's margin says how open."""
    scene = parse("1 1 1 1 0 1 5 0 0 0 0 1 0 0 0 51 2 255 0 0 / 0 0 0 1 0 1 0 255 0 / 0 0 0 -1 0 1")
    assert certify(scene).decision.item() == Decision.NEAREST
    (ray,) = explain(scene, 0, 0).rays
    assert ray.margin_decision == Decision.NEAREST
    assert ray.margin < 1e-15


def test_a_changed_decision_needs_a_change_as_large_as_the_margin() -> None:
    """A radius changed by less than a sphere's margin keeps the hit, by more than it loses it."""

    def scene(radius: float) -> Scene:
        return parse(f"1 1 1 1 0 0 5 0 0 0 0 1 0 0 0 51 1 255 0 0 * 0.9 0 0 {radius}")

    (ray,) = explain(scene(1), 0, 0).rays
    # |r^2 - l^2| / r^2 = m: a radius of r * sqrt(1 - m) touches the line.
    assert ray.margin == pytest.approx(0.19)
    touching = math.sqrt(1 - ray.margin)
    assert explain(scene(touching * 1.0001), 0, 0).rays[0].object == 0
    assert explain(scene(touching * 0.9999), 0, 0).rays[0].object == -1


@pytest.mark.parametrize("name", ["espelho2", "japao", "terra", "venn", "vidro4"])
def test_where_float32_decides_otherwise_a_margin_says_so(name: str) -> None:
    """No ray tree changes in float32 but where a margin or a start is some hundred roundings.

    Measured on the 18 packaged scenes at 240 × 320: at most 5.5e-6, 93 units of 2^-24.
    """
    with as_file(files("crosstrace.scenes") / "course" / f"{name}.txt") as file:
        scene = load(file).resized(90, 120)
    native = renderer("native")
    rough = native.render(scene, RenderOptions(precision="f32", layers=True)).layers["tree"]
    other = rough != _rendered(scene).layers["tree"]
    pixels = np.argwhere(other).tolist()
    assert name == "japao" or pixels
    margins = {}
    for row, column in [*pixels, *_pixels(scene, 100, 4)]:
        rays = explain(scene, row, column).rays
        margins[row, column] = min(min(ray.margin, ray.clearance) for ray in rays)
    assert all(margin < 1e-5 for at, margin in margins.items() if other[at])
    if name == "japao":
        assert np.median(list(margins.values())) > 1e-2


@pytest.mark.parametrize("reading", [
    "tir=add", "nesting=tracked", "mix=convex", "offset=mitsuba", "offset=bound", "view=eye",
    "exhausted=background", "depth=minus-one", "glass_shadow=clear",
])  # fmt: skip
def test_a_tree_follows_the_readings(reading: str) -> None:
    """Under another reading too the tree is the rendering's, and some pixel's is another one."""
    scene = parse(GLASS)
    readings = dict([reading.split("=")])
    made = _rendered(scene, readings)
    colors = []
    for row, column in _pixels(scene, 60, 3):
        tree = explain(scene, row, column, readings)
        assert tree.tree == made.layers["tree"][row, column]
        assert tree.color == tuple(made.image[row, column])
        total = np.sum([ray.contribution for ray in tree.rays if ray.kind != RayKind.SHADOW], 0)
        np.testing.assert_allclose(total, tree.color, rtol=0, atol=1e-12)
        colors.append((tree.color, explain(scene, row, column).color))
    assert any(other != plain for other, plain in colors)


def test_rays_beyond_the_limit_are_counted() -> None:
    """A tree of thousands of rays is cut where asked, and says how many there are."""
    shell = "0 0 0 0 0 0 1 .5 .5 1.5 * 0 0 0 1 0 0 0 0 0 0 1 .5 .5 1.3 * 0 0 0 .5"
    scene = parse(f"1 1 1 1 0 0 5 0 0 0 0 1 0 9 9 9 12 2 {shell} 0 0 0 0")
    whole, cut = explain(scene, 0, 0), explain(scene, 0, 0, max_rays=7)
    assert len(whole.rays) == whole.n_rays > 512
    assert (cut.rays, cut.n_rays, cut.tree) == (whole.rays[:7], whole.n_rays, whole.tree)


def test_a_tree_without_end_ends_in_a_clear_error() -> None:
    """Beyond the depth that a stack holds the tracer gives up in words."""
    mirrors = "0 0 0 0 0 0 1 1 0 1 / 0 0 -1 0 0 1 0 0 0 0 0 0 1 1 0 1 / 0 0 9 0 0 -1"
    scene = parse(f"1 1 1 1 0 0 5 0 0 0 0 1 0 9 9 9 2000000 2 {mirrors} 0 0 0 0")
    with pytest.raises(RendererError, match="deep"):
        explain(scene, 0, 0)


@pytest.mark.parametrize(("row", "column", "said"), [
    (30, 0, "row: expected 0 to 29, found 30"), (-1, 0, "row"),
    (0, 40, "column"), (0, -1, "column"),
])  # fmt: skip
def test_a_pixel_outside_the_image_is_refused(row: int, column: int, said: str) -> None:
    """The error names what is wrong and what would be right."""
    with pytest.raises(UsageError, match=said):
        explain(parse(GLASS), row, column)


def test_a_reading_that_does_not_exist_is_refused() -> None:
    """As for a rendering."""
    with pytest.raises(UsageError, match="tir=never"):
        explain(parse(GLASS), 0, 0, {"tir": "never"})
