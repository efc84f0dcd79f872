"""The program may be missing, hang, die, lie or complain: every case is one clear error."""

from __future__ import annotations

import os
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from crosstrace.translators.errors import (
    RendererError,
    RendererMissingError,
    UnsupportedSceneError,
)
from crosstrace.translators.povray import process
from crosstrace.translators.povray.adapter import PovRay
from crosstrace.translators.renderer import RenderOptions
from crosstrace.translators.scene import Scene, plane

OPTIONS = RenderOptions(threads=1, timeout_s=60)


def gone(pid: int) -> bool:
    """Say whether a process has ended (a zombie that init has not collected counts as ended)."""
    for _ in range(200):
        try:
            state = Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[0]
        except FileNotFoundError:
            return True
        if state == "Z":
            return True
        time.sleep(0.01)
    return False


def test_a_missing_program_names_its_remedy(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, make_scene: Callable[..., Scene]
) -> None:
    """Without the program, probing says no and how to install it, and rendering raises."""
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.delenv("CROSSTRACE_POVRAY", raising=False)
    probe = PovRay().probe()
    assert (probe.available, probe.remedy) == (False, "apt-get install povray")
    with pytest.raises(RendererMissingError, match="apt-get install povray"):
        PovRay().render(make_scene(), OPTIONS)


def test_a_program_that_cannot_be_executed_is_missing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A file without the executable bit does not count as the program."""
    (tmp_path / "povray").write_text("")
    monkeypatch.setenv("CROSSTRACE_POVRAY", str(tmp_path / "povray"))
    assert not PovRay().probe().available


def test_another_program_under_the_name_is_refused(fake_povray: Callable[[str], Path]) -> None:
    """A program that states no POV-Ray version does not count as available."""
    fake_povray("echo GNU coreutils 9.1")
    probe = PovRay().probe()
    assert not probe.available
    assert "states no POV-Ray version" in probe.reason


def test_another_major_version_is_refused(fake_povray: Callable[[str], Path]) -> None:
    """The recipe holds for POV-Ray 3.7, so 3.6 is reported with what was expected."""
    fake_povray("echo POV-Ray 3.6.1")
    probe = PovRay().probe()
    assert not probe.available
    assert probe.reason == "expected POV-Ray 3.7, found 3.6.1"


def test_the_installed_program_states_its_version(povray: PovRay) -> None:
    """Probing finds the installed program and its version number."""
    probe = povray.probe()
    assert probe.available
    assert probe.version.startswith("3.7.")


def test_a_hanging_program_is_killed_with_its_children(
    fake_povray: Callable[[str], Path], make_scene: Callable[..., Scene], tmp_path: Path
) -> None:
    """After the timeout nothing of the process group is left."""
    pids = tmp_path / "pids"
    fake_povray(f"sleep 600 & echo $! $$ > {pids}; wait")
    with pytest.raises(RendererError, match=r"timed out after 0\.5 s"):
        PovRay().render(make_scene(), RenderOptions(threads=1, timeout_s=0.5))
    assert all(gone(int(pid)) for pid in pids.read_text().split())


def test_a_program_that_dies_names_the_signal(
    fake_povray: Callable[[str], Path], make_scene: Callable[..., Scene]
) -> None:
    """A crash is told by its signal, not by an exit status."""
    fake_povray("kill -SEGV $$")
    with pytest.raises(RendererError, match="crashed with signal 11"):
        PovRay().render(make_scene(), OPTIONS)


def test_success_without_an_image_is_a_failure(
    fake_povray: Callable[[str], Path], make_scene: Callable[..., Scene]
) -> None:
    """An exit status of 0 alone proves nothing."""
    fake_povray("exit 0")
    with pytest.raises(RendererError, match="without writing an image"):
        PovRay().render(make_scene(), OPTIONS)


def test_a_cut_off_image_is_a_failure(
    fake_povray: Callable[[str], Path], make_scene: Callable[..., Scene]
) -> None:
    """An image that misses bytes is refused with both sizes."""
    fake_povray(r"printf 'P6\n80 60\n65535\n123456' > image.ppm")
    with pytest.raises(RendererError, match="wrote 6 bytes of pixels, expected 28800"):
        PovRay().render(make_scene(), OPTIONS)


def test_a_complaint_is_passed_on_without_private_paths(
    fake_povray: Callable[[str], Path], make_scene: Callable[..., Scene]
) -> None:
    """The program's own error text arrives, the temporary directory's name does not."""
    fake_povray("echo \"File '$PWD/scene.pov' line 7: Parse Error: No matching }\" >&2; exit 1")
    with pytest.raises(RendererError, match="exit status 1") as caught:
        PovRay().render(make_scene(), OPTIONS)
    assert "File 'scene.pov' line 7: Parse Error: No matching }" in str(caught.value)


def test_a_real_parse_error_is_passed_on(povray: PovRay, tmp_path: Path) -> None:
    """What the installed program says about a wrong description arrives as one sentence."""
    (tmp_path / "wrong.pov").write_text("#version 3.7;\nsphere { 1 ")
    with pytest.raises(RendererError, match="Parse Error"):
        process.run(process.find_program(), ["+Iwrong.pov", "+Oo.ppm", "-D"], tmp_path, 60)


def test_rays_beyond_the_greatest_depth_are_an_error(
    povray: PovRay, make_scene: Callable[..., Scene]
) -> None:
    """Between two perfect mirrors rays do get to depth 256, and the scene is refused."""
    walls = [
        plane([255, 255, 255], [0, side * 5, 0], [0, -side, 0], ka=0.1, kr=1.0) for side in (1, -1)
    ]
    with pytest.raises(UnsupportedSceneError, match="at most max_depth 255, found 256"):
        povray.render(make_scene(objects=walls, max_depth=256), OPTIONS)
    assert povray.render(make_scene(objects=walls, max_depth=255), OPTIONS).image.max() > 1


def test_a_directory_that_cannot_be_made_is_a_renderer_s_error(
    povray: PovRay, make_scene: Callable[..., Scene], tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:  # fmt: skip
    """Without a place for its files the renderer fails in words, and probing says so."""
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path / "missing"))
    assert "files cannot be kept" in povray.probe().reason
    with pytest.raises(RendererError, match="files cannot be kept"):
        povray.render(make_scene(), OPTIONS)


def test_an_interruption_ends_the_program(
    fake_povray: Callable[[str], Path], make_scene: Callable[..., Scene], tmp_path: Path
) -> None:
    """What the progress callback raises goes through, and the child does not survive it."""
    pid = tmp_path / "pid"
    fake_povray(f"echo $$ > {pid}; echo 'Rendered 10 of 40 pixels (25%)'; exec sleep 600")

    def interrupt(fraction: float) -> None:
        if fraction == 0.25:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        PovRay().render(make_scene(), OPTIONS, interrupt)
    assert gone(int(pid.read_text()))


def test_the_user_s_configuration_is_not_read(
    povray: PovRay, make_scene: Callable[..., Scene], tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:  # fmt: skip
    """An .ini file that would switch on anti-aliasing and another size changes nothing."""
    settings = tmp_path / "settings.ini"
    settings.write_text("Width=3\nHeight=3\nAntialias=On\nQuality=0\n")
    monkeypatch.setenv("POVINI", str(settings))
    monkeypatch.chdir(tmp_path)
    (tmp_path / "povray.ini").write_text(settings.read_text())
    scene = make_scene(v_res=5, h_res=7)
    assert povray.render(scene, OPTIONS).image.shape == (5, 7, 3)


def test_nothing_is_left_behind(
    povray: PovRay, make_scene: Callable[..., Scene], tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:  # fmt: skip
    """The private directory is gone after a rendering, and one of a killed process long ago is."""
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    left = tmp_path / "crosstrace-povray-killed_1"
    left.mkdir()
    os.utime(left, (0, 0))
    before = sorted(Path().iterdir())
    povray.render(make_scene(v_res=2, h_res=2), OPTIONS)
    assert list(tmp_path.iterdir()) == []
    assert sorted(Path().iterdir()) == before
