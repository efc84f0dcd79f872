"""The documents: what stands in them, that numbers keep their bits, that Mitsuba opens them."""

from __future__ import annotations

import shlex
import subprocess
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

from crosstrace.translators.mitsuba.document import double, is_stock, single, stock
from crosstrace.translators.mitsuba.elements import Element, Point, Reference, to_xml
from crosstrace.translators.mitsuba.files import command, file_name
from crosstrace.translators.registry import renderer
from crosstrace.translators.renderer import Renderer, RenderOptions, Translation
from crosstrace.translators.scene import Scene, plane, sphere

Build = Callable[..., Scene]

GLASS = sphere([200, 50, 50], [0, 0.1, 0], 1, ka=0.2, kd=0.6, ks=0.4, eta=20, kr=0.3, kt=0.5, n=1.4)
FLOOR = plane([100, 100, 200], [0, 0, -1], [0.1, 0, 2], ka=0.2, kd=0.6, ks=0.1, eta=3, kr=0.2)
LIGHTS = [([200, 200, 200], [3, -4, 5.1]), ([90, 50, 20], [-3, -1, 2])]
ALL = ("ambient", "diffuse", "specular", "shadows", "reflection", "refraction", "total_reflection")


def run_as_printed(translation: Translation, folder: Path) -> None:
    """Write the files and run the command, with this interpreter for `python`."""
    for name, text in translation.files.items():
        (folder / name).write_text(text, encoding="utf-8")
    words = shlex.split(translation.command)
    assert words[0] == "python"
    done = subprocess.run(
        [sys.executable, *words[1:]], cwd=folder, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr


def read_exr(path: Path) -> np.ndarray:
    import mitsuba as mi

    bitmap = mi.Bitmap(str(path)).convert(mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.Float32, False)
    return np.array(bitmap, np.float64)


def test_a_file_renders_to_the_lanes_image(
    make_scene: Build, lane: Renderer, tmp_path: Path
) -> None:
    """The translated file, run as its own line says, gives the adapter's image."""
    scene = make_scene(objects=[GLASS, FLOOR], lights=LIGHTS, max_depth=4)
    run_as_printed(lane.translate(scene, RenderOptions()), tmp_path)
    image = lane.render(scene, RenderOptions()).image
    assert np.array_equal(read_exr(tmp_path / "scene.exr"), image.astype(np.float32))
    if lane.name == "mitsuba-f64":
        assert np.array_equal(np.load(tmp_path / "scene.npy"), image)


def test_the_first_delivery_needs_no_plugin(
    make_scene: Build, single: Renderer, tmp_path: Path
) -> None:
    """Its file and its line name nothing of this project, and give the image."""
    things = [sphere([200, 51, 50], [0, 0, 0], 1), plane([100, 100, 200], [0, 0, -1], [0, 0, 2])]
    scene = make_scene(delivery=1, objects=things)
    translation = single.translate(scene, RenderOptions())
    assert "crosstrace" not in translation.files["scene.xml"] + translation.command
    run_as_printed(translation, tmp_path)
    image = single.render(scene, RenderOptions()).image
    assert np.abs(read_exr(tmp_path / "scene.exr") - image).max() <= 2.0**-23


def test_translating_needs_no_mitsuba() -> None:
    """A file can be written where Mitsuba is not installed: nothing imports it."""
    program = (
        "import sys; sys.modules['mitsuba'] = sys.modules['drjit'] = None\n"
        "from crosstrace.translators.registry import renderer\n"
        "from crosstrace.translators.renderer import RenderOptions\n"
        "from crosstrace.translators.scene import Scene\n"
        "scene = Scene.build(delivery=3, v_res=1, h_res=1, pixel_size=1, screen_distance=1,"
        " eye=[0, 0, 0], target=[0, 1, 0], up=[0, 0, 1], background=[0, 0, 0])\n"
        "for lane in ('mitsuba', 'mitsuba-f64'):\n"
        "    assert renderer(lane).translate(scene, RenderOptions()).files\n"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, check=False)
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("name", ["a b", "--><x/>", "q\"u'o;te$(x)", "../up", "", "…"])
def test_no_name_gets_into_a_file_or_line(name: str, make_scene: Build) -> None:
    """A scene's name is its author's text: only harmless letters of it reach the file's name."""
    scene = replace(make_scene(objects=[FLOOR]), name=name)
    translation = renderer("mitsuba").translate(scene, RenderOptions())
    (file, text), *_ = translation.files.items()
    assert set(file) <= set("abcdefghijklmnopqrstuvwxyz_.-")
    assert len(shlex.split(translation.command)) == 3
    plain = renderer("mitsuba").translate(make_scene(objects=[FLOOR]), RenderOptions())
    assert text == plain.files["scene.xml"]


def test_numbers_are_written_to_the_last_bit(make_scene: Build) -> None:
    """Every number of the exact document reads back from its XML as the same double."""
    ball = sphere([1 / 3, 50, 50], [0.1, 1e-17, 1e5 / 7], 0.1 + 0.2, ka=1 / 3)
    root = ElementTree.fromstring(to_xml(double(make_scene(objects=[ball]), ALL), "note"))
    phong = root.find("integrator/bsdf")
    assert phong is not None
    numbers = {tag.get("name"): float(tag.get("value") or 0) for tag in phong.findall("float")}
    place = phong.find("point[@name='place']")
    assert place is not None
    assert numbers["radius"] == 0.1 + 0.2
    assert numbers["ka"] == 1 / 3
    assert [float(place.get(axis) or "nan") for axis in "xyz"] == [0.1, 1e-17, 1e5 / 7]


def test_texts_are_escaped() -> None:
    """Whatever a text holds, the file stays well-formed and the text comes back."""
    text = "\"<&>'"
    element = Element("bsdf", "x", "y", {"text": text, "at": Point((1.0, 2.0, 3.0))})
    root = ElementTree.fromstring(to_xml([element], "note"))
    found = root.find("bsdf/string")
    assert found is not None
    assert found.get("value") == text


def test_equal_materials_are_written_once(make_scene: Build) -> None:
    """Objects of one look share one material."""
    balls = [sphere([9, 9, 9], [i, 0, 0], 0.4, ka=0.5) for i in range(5)]
    elements = single(make_scene(objects=[*balls, FLOOR]), ALL)
    assert sum(element.tag == "bsdf" for element in elements) == 2


def test_hidden_twins_are_left_out_of_float32_documents(make_scene: Build) -> None:
    """Of equal surfaces only the first in the file is written: the others never show."""
    elements = single(make_scene(objects=[GLASS, FLOOR, {**GLASS, "color": [0, 0, 0]}]), ALL)
    assert [e.id for e in elements if e.tag == "shape"] == ["object_0", "object_1"]
    worn = [e.values["material"] for e in elements if e.tag == "shape"]
    assert all(isinstance(reference, Reference) for reference in worn)


def test_only_a_flat_first_delivery_is_stock(make_scene: Build) -> None:
    """Light, a masked effect or a huge angle of view call for our plugins."""
    ball = sphere([9, 9, 9], [0, 0, 0], 1)
    flat = make_scene(delivery=1, objects=[ball])
    assert is_stock(flat, {"flat"})
    assert not is_stock(flat, set())
    assert not is_stock(make_scene(objects=[ball]), {"ambient"})
    assert not is_stock(make_scene(delivery=1, objects=[ball], screen_distance=1e-9), {"flat"})
    assert {e.plugin for e in stock(flat)} == {"aov", "perspective", "diffuse", "sphere"}


def test_the_line_imports_plugins_only_where_needed(make_scene: Build) -> None:
    """The line for a stock file runs with nothing but Mitsuba installed."""
    scene = make_scene(objects=[FLOOR])
    assert "plugins" in command(single(scene, ALL), "a.xml")
    assert "plugins" not in command(stock(scene), "a.xml")


def test_file_names_are_never_empty() -> None:
    """A scene without a usable name gets one."""
    assert file_name("") == "scene.xml"
    assert file_name("...") == "scene.xml"
    assert file_name("espelho0") == "espelho0.xml"
