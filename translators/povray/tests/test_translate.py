"""A translated scene is one text that plain `povray` renders to the image of the lane."""

from __future__ import annotations

import shlex
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from crosstrace.translators.errors import UnsupportedSceneError
from crosstrace.translators.povray.adapter import PovRay
from crosstrace.translators.renderer import RenderOptions
from crosstrace.translators.scene import Scene, plane, sphere

OBJECTS: list[dict[str, Any]] = [
    plane([120, 200, 90], [0, 0, 0], [0, 0, 1], ka=0.3, kd=0.9, ks=0.5, eta=3),
    sphere([200, 240, 220], [0, -1, 0.8], 0.6, ks=0.5, eta=50, kr=0.1, kt=0.9, n=1.5),
]
LIGHTS = [([255, 255, 255], [-2, -3, 4]), ([255, 255, 255], [0, 1, -3])]


def test_plain_povray_renders_the_same_image(
    povray: PovRay, make_scene: Callable[..., Scene], tmp_path: Path
) -> None:
    """The stated command line and scale give the lane's image, within both quantisations."""
    import OpenImageIO

    scene = make_scene(objects=OBJECTS, lights=LIGHTS, name="room")
    translation = povray.translate(scene, RenderOptions())
    ((name, text),) = translation.files.items()
    (tmp_path / name).write_text(text)
    subprocess.run(shlex.split(translation.command), cwd=tmp_path, check=True,
                   capture_output=True, timeout=60)  # fmt: skip
    image = OpenImageIO.ImageBuf(str(tmp_path / "room.png"))
    assert str(image.spec().format) == "uint16"
    (line,) = [line for line in text.splitlines() if "multiply it by" in line]
    scale = float(line.rpartition("= ")[2].rstrip("."))
    samples = image.get_pixels(OpenImageIO.UINT16).astype(np.float64) / 65535 * scale
    lane = povray.render(scene, RenderOptions(threads=1))
    assert np.abs(samples - lane.image).max() <= scale / 131070 + lane.half_step + 1e-6


def test_the_comment_holds_the_whole_command(make_scene: Callable[..., Scene]) -> None:
    """The first line is what to type; size and every switch are in it."""
    translation = PovRay().translate(make_scene(name="room"), RenderOptions())
    ((name, text),) = translation.files.items()
    assert name == "room.pov"
    assert text.splitlines()[0] == f"// {translation.command}"
    assert "+W80 +H60" in translation.command


@pytest.mark.parametrize("name", ["../../x", "a\n#include", "-D; rm", "", "é", "x" * 300])
def test_a_hostile_name_becomes_a_harmless_file_name(
    make_scene: Callable[..., Scene], name: str
) -> None:
    """File and command hold letters, digits, `_` and `-` of a scene's name, nothing else."""
    translation = PovRay().translate(make_scene(name=name), RenderOptions())
    ((file, text),) = translation.files.items()
    assert file.removesuffix(".pov").replace("-", "").replace("_", "").isalnum()
    assert not file.startswith("-")
    assert len(file) < 100
    assert sum(line.startswith("//") for line in text.splitlines()) == 5


def test_what_plain_povray_cannot_tell_is_said(make_scene: Callable[..., Scene]) -> None:
    """Values that may be cut and rays that may be missing are announced in the comment."""
    modest = PovRay().translate(make_scene(objects=OBJECTS, lights=LIGHTS), RenderOptions())
    mirror = sphere([255, 255, 255], [0, 0, 0], 1.0, ka=0.5, kr=1.0)
    deep = PovRay().translate(make_scene(objects=[mirror], max_depth=300), RenderOptions())
    for words in ("Values beyond output_scale are cut", "more than 255 bounces"):
        assert words not in modest.files["scene.pov"]
        assert words in deep.files["scene.pov"]


def test_another_reading_is_refused(make_scene: Callable[..., Scene]) -> None:
    """POV-Ray renders the default readings; one that deviates is an error, not ignored."""
    options = RenderOptions(readings={"tir": "ignore"})
    with pytest.raises(UnsupportedSceneError, match="tir=ignore"):
        PovRay().translate(make_scene(), options)
