"""The native lane: the course's official images, side outputs, and an interrupted rendering."""

from __future__ import annotations

import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from crosstrace.translators.course import load, parse
from crosstrace.translators.errors import RendererError, UsageError
from crosstrace.translators.registry import renderer
from crosstrace.translators.renderer import RenderOptions

OFFICIAL = ("bolha2", "espelho0", "espelho2", "japao", "olho", "piramide", "terra", "venn",
            "vidro4")  # fmt: skip
IDENTICAL = {"piramide", "japao", "olho", "venn", "espelho2"}
GLASS = (
    "30 40 0.04 1 0 -6 1.5 0 0 0.8 0 0 1 120 170 230 4 4 "
    "220 220 220 0.2 0.7 0 1 0.2 0 1 / 0 0 0 0 0 1 "
    "230 60 60 0.1 0.7 0.4 50 0.1 0 1 * -1.1 1 1 1 "
    "30 30 30 0.0 0.1 0.5 200 0.1 0.8 1.5 * 0 -0.5 1 1 "
    "60 60 230 0.1 0.7 0.4 20 0.6 0 1 * 1.3 1.2 1 1 "
    "255 255 255 2 150 150 150 -4 -5 6 120 120 120 3 -2 5"
)


def _bytes(image: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Apply the 8-bit rule of the design, section 1; also say where 255·v is near an integer."""
    scaled = 255 * (image / np.maximum(1.0, image.max(axis=2, keepdims=True)))
    return (scaled + 1e-9).astype(int), np.abs(scaled - np.rint(scaled)) <= 1e-9


@pytest.mark.parametrize("name", OFFICIAL)
def test_the_official_image_is_matched(official: Path, name: str) -> None:
    """No level differs but where 255·v is within 1e-9 of an integer, and there by one at most."""
    from skimage.io import imread

    readings = {"plane_normal": "raw"} if name == "piramide" else {}
    rendering = renderer("native").render(
        load(official / f"{name}.txt"), RenderOptions(readings=readings)
    )
    levels, tie = _bytes(rendering.image)
    difference = np.abs(levels - imread(official / f"{name}.png")[..., :3].astype(int))
    assert difference[~tie].max(initial=0) == 0
    assert difference.max() <= 1
    if name in IDENTICAL:
        assert difference.max() == 0


def test_contributions_add_up_to_the_image() -> None:
    """The six terms of a pixel's first hit are all of it, but for rounding."""
    rendering = renderer("native").render(parse(GLASS), RenderOptions(layers=True))
    total = rendering.layers["contributions"].sum(axis=2)
    assert np.abs(total - rendering.image).max() <= 1e-15
    # Every term but total reflection is met in this scene, so a lost one would be seen.
    assert (rendering.layers["contributions"].max(axis=(0, 1, 3))[:5] > 0).all()


def test_layers_agree_with_each_other() -> None:
    """Where no object is hit, there is no distance, no normal, and a single ray."""
    layers = renderer("native").render(parse(GLASS), RenderOptions(layers=True)).layers
    sky = layers["object"] < 0
    assert sky.any() and not sky.all()
    assert np.isinf(layers["t"][sky]).all() and np.isfinite(layers["t"][~sky]).all()
    assert (layers["normal"][sky] == 0).all()
    assert np.allclose(np.linalg.norm(layers["normal"][~sky], axis=1), 1, atol=1e-14)
    assert (layers["rays"][sky] == 1).all() and (layers["rays"][~sky] > 1).all()
    assert len(np.unique(layers["tree"][sky])) == 1


def test_asking_for_layers_changes_no_pixel() -> None:
    """Looking does not disturb."""
    native = renderer("native")
    plain = native.render(parse(GLASS), RenderOptions()).image
    assert np.array_equal(plain, native.render(parse(GLASS), RenderOptions(layers=True)).image)


@pytest.mark.parametrize("text", ["tir=sometimes", "no_such_reading=1", "epsilon=-1", "epsilon=x"])
def test_an_unknown_reading_is_a_usage_error(text: str) -> None:
    """Names and values that do not exist are refused, with what would be right."""
    name, value = text.split("=")
    with pytest.raises(UsageError, match="expected"):
        renderer("native").render(parse(GLASS), RenderOptions(readings={name: value}))


def test_an_exponential_ray_tree_ends_in_a_clear_error() -> None:
    """Between the surfaces of a glass shell both branches stay: 2^100 rays, but for the budget."""
    from crosstrace.native import _core

    shell = "0 0 0 0 0 0 1 .5 .5 1.5 * 0 0 0 1 0 0 0 0 0 0 1 .5 .5 1.3 * 0 0 0 .5"
    scene = parse(f"1 1 1 1 0 0 5 0 0 0 0 1 0 9 9 9 100 2 {shell} 0 0 0 0")
    with pytest.raises(RuntimeError, match="ray budget"):
        _core.render(scene.native_view(), [("ray_budget", "100000")], {}, None)


def test_an_image_too_large_for_memory_is_refused() -> None:
    """A resolution that no array holds is a RendererError and no crash."""
    with pytest.raises(RendererError, match="pixels"):
        renderer("native").render(parse(GLASS).resized(1 << 20, 1 << 20), RenderOptions())


def test_ctrl_c_ends_a_rendering() -> None:
    """A rendering of hours gives way to SIGINT, as KeyboardInterrupt, while threads still run."""
    script = (
        "import time\n"
        "from crosstrace.translators.course import parse\n"
        "from crosstrace.native import _core\n"
        f"view = list(parse({GLASS!r}).native_view())\n"
        "view[1] = view[2] = 1 << 20\n"
        "print('ready', flush=True)\n"
        "try:\n"
        "    _core.render(tuple(view), [], {}, None)\n"
        "except KeyboardInterrupt:\n"
        "    print('interrupted', flush=True)\n"
    )
    child = subprocess.Popen([sys.executable, "-c", script], stdout=subprocess.PIPE, text=True)
    assert child.stdout is not None
    assert child.stdout.readline() == "ready\n"
    time.sleep(0.3)
    child.send_signal(signal.SIGINT)
    assert child.communicate(timeout=60)[0] == "interrupted\n"
