"""`import crosstrace`: the names, and that no renderer can take the caller down."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from command_line import SCENE, python, scene_file

import crosstrace as ct


@pytest.fixture
def scene(tmp_path: Path) -> ct.Scene:
    """Read the small scene."""
    return ct.load(scene_file(tmp_path))


def test_importing_the_package_imports_nothing_heavy() -> None:
    """Only using a name imports what it needs."""
    program = (
        "import sys, crosstrace\n"
        "heavy = {'numpy', 'mitsuba', 'OpenImageIO', 'skimage', 'rich', 'click'}\n"
        "print(sorted(heavy & set(sys.modules)))\n"
    )
    assert python(program).stdout == "[]\n"


def test_every_public_name_is_there_and_no_other() -> None:
    """`__all__` can be imported, `dir` lists it, and a misspelling is an AttributeError."""
    for name in ct.__all__:
        assert getattr(ct, name) is not None
    assert set(ct.__all__) <= set(dir(ct))
    misspelled = "rendre"
    with pytest.raises(AttributeError, match="no attribute 'rendre'"):
        getattr(ct, misspelled)


@pytest.mark.parametrize("from_input", [False, True], ids=["plain script", "standard input"])
def test_a_script_needs_no_main_guard(tmp_path: Path, from_input: bool) -> None:
    """Workers are started as a module of ours, never from the caller's script."""
    scene_file(tmp_path)
    program = (
        "import crosstrace as ct\n"
        "scene = ct.load('tiny.txt')\n"
        "a, b = (ct.render(scene, lane) for lane in ('native', 'mitsuba-f64'))\n"
        "print(a.shape, a.dtype, ct.compare(a, b, scene=scene).metrics.over['over_1e_9'])\n"
    )
    done = python(program, cwd=tmp_path, from_input=from_input)
    assert (done.stdout, done.stderr) == ("(12, 16, 3) float64 0\n", "")


@pytest.mark.parametrize("lane", ct.LANES)
def test_every_lane_renders_linear_float64(scene: ct.Scene, lane: str) -> None:
    """Shape, type and the background at the top are those of the contract."""
    image = ct.render(scene, lane)
    assert image.shape == scene.shape
    assert image.dtype == np.float64
    np.testing.assert_allclose(image[0, 0], np.array([10, 20, 30]) / 255, atol=1e-5)


def test_a_scene_built_in_python_renders_as_its_file_does(scene: ct.Scene) -> None:
    """The same numbers give the same scene, and the same image to the last bit."""
    built = ct.Scene.build(
        delivery=3, v_res=12, h_res=16, pixel_size=0.06, screen_distance=1.0,
        eye=[0, -5, 1], target=[0, 0, 1], up=[0, 0, 1], background=[10, 20, 30], max_depth=1,
        objects=[
            ct.sphere((255, 0, 0), (0, 0, 1), 1, ka=0.1, kd=0.7, ks=0.3, eta=20, n=1),
            ct.plane((200, 200, 200), (0, 0, 0), (0, 0, 1), ka=0.1, kd=0.5, ks=0, eta=1, kr=0.4),
        ],
        ambient=[255, 255, 255], lights=[((255, 255, 255), (3, -4, 6))],
    )  # fmt: skip
    assert built == scene
    assert np.array_equal(ct.render(built), ct.render(scene))


def test_a_scene_built_in_python_is_validated() -> None:
    """A negative radius is refused, and the error names the field."""
    with pytest.raises(ct.SceneError, match=r"objects\[0\]\.radius: expected .*, found "):
        ct.Scene.build(
            delivery=1, v_res=4, h_res=4, pixel_size=1.0, screen_distance=1.0,
            eye=[0, -5, 1], target=[0, 0, 1], up=[0, 0, 1], background=[0, 0, 0],
            objects=[ct.sphere((255, 0, 0), (0, 0, 1), -1)],
        )  # fmt: skip


def test_options_reach_the_renderer(scene: ct.Scene) -> None:
    """Readings change the image, layers come beside it, and progress is told."""
    told: list[float] = []
    full = ct.render_full(scene, layers=True, progress=told.append)
    assert full.layers["object"].shape == (12, 16)
    other = ct.render(scene, readings={"depth": "minus-one"})
    assert not np.array_equal(other, full.image)
    assert all(0 <= fraction <= 1 for fraction in told)


def test_only_the_effects_asked_for_are_rendered(scene: ct.Scene) -> None:
    """Without shadows and mirrors the image differs; with the scene's own effects it does not."""
    called_for = ct.effects(scene).names
    assert np.array_equal(ct.render(scene, effects=called_for), ct.render(scene))
    assert not np.array_equal(ct.render(scene, effects=["ambient"]), ct.render(scene))


def test_a_crash_reaches_the_caller_as_an_error_and_the_next_call_works(scene: ct.Scene) -> None:
    """The process of the renderer dies, this one does not, and another worker takes over."""
    with pytest.raises(ct.RendererError, match="SIGSEGV"):
        ct.render(scene, "fake_lanes:Crashing")
    assert ct.render(scene, "fake_lanes:Gradient").shape == scene.shape
    assert ct.render(scene).shape == scene.shape


def test_a_renderer_that_hangs_is_given_up(scene: ct.Scene) -> None:
    """The limit ends the call, with an error that states it."""
    with pytest.raises(ct.RendererError, match=r"timed out after 0\.5 s"):
        ct.render(scene, "fake_lanes:Hanging", timeout_s=0.5)


def test_errors_keep_their_kind_and_their_parts(scene: ct.Scene, tmp_path: Path) -> None:
    """What a worker raises can be caught here by its class, and says what to do."""
    with pytest.raises(ct.RendererMissingError) as missing:
        ct.render(scene, "fake_lanes:Absent")
    assert missing.value.remedy
    with pytest.raises(ct.UnsupportedSceneError):
        ct.render(scene, "fake_lanes:Refusing")
    with pytest.raises(ct.UsageError, match=r"expected .* found 'radiance'"):
        ct.render(scene, "radiance")
    with pytest.raises(ct.UsageError, match="tir=never"):
        ct.render(scene, readings={"tir": "never"})
    with pytest.raises(ct.SceneError) as bad:
        ct.load(scene_file(tmp_path, SCENE.replace("12 16", "12 0"), "bad.txt"))
    assert (bad.value.line, bad.value.column) == (1, 4)


def test_compare_measures_and_checks_the_scene(scene: ct.Scene) -> None:
    """Numbers are those of the definition; an image of another size is refused."""
    a = ct.render(scene)
    b = a.copy()
    b[5, 5, 0] += 0.25
    found = ct.compare(a, b, scene=scene)
    assert found.metrics.max == 0.25
    assert found.metrics.rmse == pytest.approx(0.25 / math.sqrt(a.size))
    assert found.ssim is not None and 0 < found.ssim < 1
    assert ct.compare(a, a).metrics.identical
    with pytest.raises(ct.UsageError, match="12x16, found 11x16"):
        ct.compare(a[1:], b[1:], scene=scene)


def test_run_from_python_leaves_a_report(scene: ct.Scene, tmp_path: Path) -> None:
    """`run` returns the record that it writes."""
    report = ct.run([scene], tmp_path / "out", ct.RunOptions(lanes=("native",)))
    assert report["scenes"][0]["sha256"] == scene.sha256
    assert (tmp_path / "out" / "report.html").is_file()


def test_probe_and_translate_work_from_python(scene: ct.Scene) -> None:
    """A lane says whether it works, and writes the scene in its own language."""
    assert ct.probe("native").available
    assert not ct.probe("fake_lanes:Absent").available
    assert "camera" in next(iter(ct.translate(scene, "povray").files.values()))


def test_a_fork_of_the_caller_renders_too(tmp_path: Path) -> None:
    """A child that has inherited warm workers starts its own and leaves its parent's alone."""
    scene_file(tmp_path)
    program = (
        "import os, crosstrace as ct\n"
        "scene = ct.load('tiny.txt')\n"
        "ct.render(scene)\n"
        "child = os.fork()\n"
        "image = ct.render(scene)\n"
        "if child == 0:\n"
        "    raise SystemExit(int(image.shape != scene.shape))\n"
        "print(os.waitpid(child, 0)[1], ct.render(scene).shape)\n"
    )
    done = python(program, cwd=tmp_path)
    assert done.stdout == "0 (12, 16, 3)\n", done.stderr
