"""The precision ladder on whole scenes: against float128, and under the rounding modes."""

from __future__ import annotations

from importlib.resources import as_file, files

import numpy as np
import pytest

from crosstrace.native import _core
from crosstrace.translators.course import load, parse
from crosstrace.translators.errors import UsageError
from crosstrace.translators.native.digits import digits_lost, images_by_mode
from crosstrace.translators.native.truth import certify
from crosstrace.translators.registry import renderer
from crosstrace.translators.renderer import Rendering, RenderOptions
from crosstrace.translators.scene import Scene

PACKAGED = ("bolha4", "canto", "eclipse", "espelho3", "ilhas", "piramide", "polonia", "sinuca",
            "terra", "vidro4")  # fmt: skip
ROWS, COLUMNS = 45, 60
ROOM = (
    "30 40 0.04 1 0 -6 1.5 0 0 0.8 0 0 1 120 170 230 4 4 "
    "220 220 220 0.2 0.7 0 1 0.2 0 1 / 0 0 0 0 0 1 "
    "230 60 60 0.1 0.7 0.4 50.5 0.1 0 1 * -1.1 1 1 1 "
    "30 30 30 0.0 0.1 0.5 200 0.1 0.8 1.5 * 0 -0.5 1 1 "
    "60 60 230 0.1 0.7 0.4 1e5 0.6 0 1 * 1.3 1.2 1 1 "
    "255 255 255 2 150 150 150 -4 -5 6 120 120 120 3 -2 5"
)
needs_f128 = pytest.mark.skipif(
    "f128" not in _core.precisions(), reason="this platform has no __float128 to compare with"
)


def _render(scene: Scene, precision: str) -> Rendering:
    return renderer("native").render(scene, RenderOptions(precision=precision, layers=True))


def _error(rendering: Rendering, truth: Rendering) -> np.ndarray:
    zero = np.zeros_like(truth.image)
    low = rendering.layers.get("image_low", zero) - truth.layers["image_low"]
    return np.abs((rendering.image - truth.image) + low).max(axis=-1)


def _packaged(name: str) -> Scene:
    with as_file(files("crosstrace.scenes") / "course" / f"{name}.txt") as path:
        return load(path).resized(ROWS, COLUMNS)


@needs_f128
@pytest.mark.parametrize("name", PACKAGED)
def test_decidable_pixels_have_the_same_tree_in_every_wide_precision(name: str) -> None:
    """Double makes float128's decisions and errs by 1e-12 at most; wider types by far less."""
    scene = _packaged(name)
    decidable = ~certify(scene).undecidable
    truth = _render(scene, "f128")
    # float128 and double trees agree, so nothing but rounding is left between them.
    bounds = {"f64": 1e-12, "f64c": 1e-12, "f80": 1e-15, "dd": 1e-27}
    for precision, bound in bounds.items():
        if precision not in _core.precisions():
            continue
        rendering = _render(scene, precision)
        same = rendering.layers["tree"] == truth.layers["tree"]
        assert same[decidable].all(), precision
        assert _error(rendering, truth)[decidable].max(initial=0) <= bound, precision


@needs_f128
def test_official_scenes_are_traced_alike(official: object) -> None:
    """The course's own scenes too: every decidable pixel's tree, and errors within 1e-12."""
    from pathlib import Path

    for path in sorted(Path(str(official)).glob("*.txt")):
        scene = load(path).resized(ROWS, COLUMNS)
        decidable = ~certify(scene).undecidable
        truth, double = _render(scene, "f128"), _render(scene, "f64")
        assert (double.layers["tree"] == truth.layers["tree"])[decidable].all(), path.name
        assert _error(double, truth)[decidable].max(initial=0) <= 1e-12, path.name


@needs_f128
def test_compensation_pays_where_a_floor_is_a_sphere_of_a_million() -> None:
    """Plain double loses digits of such a floor, compensated primitives keep them."""
    text = ROOM.replace("/ 0 0 0 0 0 1", "* 0 0 -1e6 1e6").replace("1e5 0.6", "20 0.6")
    scene = parse(text)
    truth = _render(scene, "f128")
    plain, compensated = (_error(_render(scene, p), truth) for p in ("f64", "f64c"))
    assert plain.max() > 1e-12
    assert compensated.max() < 1e-12
    assert compensated.max() < plain.max() / 100


@needs_f128
def test_float_is_sane() -> None:
    """Float decides a few edge pixels otherwise and elsewhere errs by its own digits."""
    scene = parse(ROOM).resized(90, 120)
    truth, rendering = _render(scene, "f128"), _render(scene, "f32")
    same = rendering.layers["tree"] == truth.layers["tree"]
    assert (~same).mean() < 0.02
    error = _error(rendering, truth)
    assert np.quantile(error[same], 0.99) < 1e-5


def test_an_absent_precision_is_named_with_those_present() -> None:
    """A wrong precision is a wrong option, and the message lists the right ones."""
    with pytest.raises(UsageError, match=r"expected one of f32, f64, f64c, .*found 'f16'"):
        renderer("native").render(parse(ROOM), RenderOptions(precision="f16"))


def test_the_probe_lists_the_ladder() -> None:
    """What `doctor` says of the native lane names every precision that exists here."""
    details = renderer("native").probe().details
    assert details["precisions"].split() == _core.precisions()


@pytest.mark.parametrize("precision", ["f32", "f64", "f80"])
def test_rounding_modes_lose_some_digits_of_a_sane_scene(precision: str) -> None:
    """Every mode renders another image, and most pixels lose a handful of bits only."""
    if precision not in _core.precisions():
        pytest.skip(f"this platform has no {precision}")
    scene = parse(ROOM)
    modes = images_by_mode(scene, precision)
    assert all((modes[0] != modes[k]).any() for k in range(1, 4))
    lost = digits_lost(scene, precision)
    assert lost.shape == (scene.v_res, scene.h_res)
    assert (lost >= 0).all()
    assert 0 < np.median(lost) < 12


def test_rounding_modes_find_the_ill_conditioned_floor() -> None:
    """A floor that is a sphere of a million costs plainly more digits than a plane."""
    sphere = parse(ROOM.replace("/ 0 0 0 0 0 1", "* 0 0 -1e6 1e6"))
    lost = [np.quantile(digits_lost(scene), 0.9) for scene in (sphere, parse(ROOM))]
    assert lost[0] > lost[1] + 3


@pytest.mark.parametrize("precision", ["f64c", "dd", "f128", "f16"])
def test_error_free_precisions_refuse_other_rounding_modes(precision: str) -> None:
    """Their exact sums need rounding to nearest; nobody gets a map that means nothing."""
    with pytest.raises(UsageError, match="rounding modes: expected f32"):
        digits_lost(parse(ROOM), precision)


@pytest.mark.parametrize("precision", _core.precisions())
def test_every_instruction_set_gives_the_same_bits(precision: str) -> None:
    """With the processor's instruction sets switched off one by one, no rung changes a bit."""
    scene = parse(ROOM)
    images = []
    for most in ("native", *_core.instructions()):
        image, low = np.empty((2, *scene.shape))
        trees = np.empty(scene.shape[:2], np.uint64)
        settings = [("precision", precision), ("instructions", most)]
        outputs = {"image": image, "image_low": low, "tree": trees}
        _core.render(scene.native_view(), settings, outputs, None)
        images.append((image.tobytes(), low.tobytes(), trees.tobytes()))
    assert len(images) >= 2
    assert all(other == images[0] for other in images)


def test_every_instruction_set_certifies_alike() -> None:
    """So do the enclosures, at a tolerance that sends pixels through double-double too."""
    scene = parse(ROOM)
    found = []
    for most in ("native", *_core.instructions()):
        lo, hi = np.empty((2, *scene.shape))
        level = np.empty(scene.shape[:2], np.uint8)
        outputs = {"lo": lo, "hi": hi, "level": level}
        settings = [("instructions", most)]
        closed = _core.certify(scene.native_view(), settings, None, 1e-15, 0.0, outputs, None)
        assert closed["double-double"] > 100
        found.append((lo.tobytes(), hi.tobytes(), level.tobytes()))
    assert all(other == found[0] for other in found)


def test_an_instruction_set_that_does_not_exist_is_refused() -> None:
    """A misspelled cap would otherwise switch nothing off."""
    with pytest.raises(ValueError, match=r"instructions: expected scalar\|generic\|fma"):
        _core.render(parse(ROOM).native_view(), [("instructions", "sse9")], {}, None)
