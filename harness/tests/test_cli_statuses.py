"""How the command ends: exit statuses, and what it says where it refuses or fails."""

from __future__ import annotations

from pathlib import Path

import pytest
from command_line import NO_POVRAY, SCENE, call, fake_povray, python, scene_file

HEAVY = ("numpy", "mitsuba", "drjit", "OpenImageIO", "skimage", "rich", "jinja2")


@pytest.mark.parametrize("words", [["--help"], ["--version"], *(
    [name, "--help"]
    for name in ("run", "render", "translate", "compare", "explain", "effects", "report", "doctor")
)], ids=" ".join)  # fmt: skip
def test_help_costs_nothing_heavy(words: list[str]) -> None:
    """Help is answered without numpy, a renderer, or any other large package being imported."""
    program = (
        "import sys\n"
        "from crosstrace.harness.cli import main\n"
        f"status = main({words!r})\n"
        f"loaded = [name for name in {HEAVY!r} if name in sys.modules]\n"
        "sys.exit(f'imported {loaded}' if loaded else status)\n"
    )
    done = python(program)
    assert (done.returncode, done.stderr) == (0, "")
    assert "crosstrace" in done.stdout


def test_the_overview_names_every_command_that_there_is() -> None:
    """Each module in `commands` that holds a command is in the overview, and vice versa."""
    import crosstrace.harness.commands
    from crosstrace.harness.cli import COMMANDS

    folder = Path(crosstrace.harness.commands.__file__ or "").parent
    texts = {path.stem: path.read_text(encoding="utf-8") for path in folder.glob("*.py")}
    modules = {name for name, text in texts.items() if "\ndef command(" in text}
    assert modules == set(COMMANDS)
    overview = call("--help").stdout
    assert all(f"  {name} " in overview for name in COMMANDS)


@pytest.mark.parametrize("words", [
    ["paint"],
    ["render"],
    ["render", "{scene}"],
    ["render", "{scene}", "-o", "x.gif"],
    ["render", "{scene}", "-o", "x.png", "--size", "0x4"],
    ["render", "{scene}", "-o", "x.png", "--size", "4"],
    ["render", "{scene}", "-o", "x.png", "--delivery", "4"],
    ["render", "{scene}", "-o", "x.png", "--with", "radiance"],
    ["render", "{scene}", "-o", "x.png", "--with", "native,povray"],
    ["render", "{scene}", "-o", "x.png", "--set", "colour=blue"],
    ["render", "{scene}", "-o", "x.png", "--set", "tir=never"],
    ["render", "{scene}", "-o", "x.png", "--set", "overflow=wrap"],
    ["render", "{scene}", "-o", "x.npz", "--set", "overflow=clamp"],
    ["render", "{scene}", "-o", "x.png", "--aov"],
    ["render", "{scene}", "-o", "x.npz", "--aov", "--with", "mitsuba"],
    ["render", "{scene}", "-o", "x.png", "--certify"],
    ["render", "{scene}", "-o", "nowhere/x.png"],
    ["render", "{scene}", "-o", "."],
    ["render", "nowhere.txt", "-o", "x.png"],
    ["run", "{scene}", "--renderers", "native,radiance"],
    ["run", "{scene}", "--renderers", ","],
    ["run", "{scene}", "--jobs", "0"],
    ["run", "{scene}", "--timeout", "0"],
    ["run", "nowhere"],
    ["translate", "{scene}", "--to", "radiance"],
    ["compare", "x.npy", "y.npy"],
    ["explain", "{scene}", "12", "0"],
    ["explain", "{scene}", "0", "16"],
    ["explain", "{scene}", "0", "-1"],
    ["explain", "{scene}", "0"],
    ["explain", "{scene}", "zero", "0"],
    ["explain", "{scene}", "0", "0", "--renderers", "radiance"],
    ["explain", "{scene}", "0", "0", "--set", "tir=never"],
    ["explain", "nowhere.txt", "0", "0"],
    ["effects", "nowhere.txt"],
    ["report", "report.json"],
    ["report", "{scene}"],
    ["doctor", "--renderers", "radiance"],
], ids=" ".join)  # fmt: skip
def test_wrong_usage_ends_with_2_and_leaves_nothing(tmp_path: Path, words: list[str]) -> None:
    """A wrong option, name or combination is refused before any work, in words."""
    scene = scene_file(tmp_path)
    done = call(*(word.format(scene=scene.name) for word in words), cwd=tmp_path)
    assert done.returncode == 2
    assert done.stdout == ""
    assert done.stderr
    assert "Traceback" not in done.stderr
    assert [path.name for path in tmp_path.iterdir()] == [scene.name]


@pytest.mark.parametrize("words", [
    ["render", "-o", "x.npz"], ["translate", "--to", "povray"], ["effects"], ["run"],
    ["compare", "a.npy", "b.npy", "--scene"],
], ids=lambda words: words[0])  # fmt: skip
def test_a_malformed_scene_is_refused_with_file_line_and_column(
    tmp_path: Path, words: list[str]
) -> None:
    """The radius of the second line of objects is wrong: its place is named, nothing is written."""
    text = SCENE.replace("* 0 0 1 1", "* 0 0 1 -1")
    line = next(i for i, row in enumerate(text.splitlines(), 1) if "-1" in row and "*" in row)
    column = text.splitlines()[line - 1].rindex("-1") + 1
    scene_file(tmp_path, text)
    done = call(*words, "tiny.txt", cwd=tmp_path)
    assert done.returncode == 2
    assert f"tiny.txt:{line}:{column}: expected " in done.stderr
    assert ", found " in done.stderr
    assert "Traceback" not in done.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["tiny.txt"]


def test_one_bad_scene_among_many_is_refused_before_anything_is_rendered(tmp_path: Path) -> None:
    """A run reads every scene first, so it never stops halfway for a bad file."""
    folder = tmp_path / "scenes"
    folder.mkdir()
    scene_file(folder, name="a.txt")
    scene_file(folder, SCENE + "7", name="b.txt")
    done = call("run", folder, "-o", tmp_path / "out")
    assert done.returncode == 2
    assert "b.txt:12:1: expected " in done.stderr
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("words", [
    ["render", "tiny.txt", "--with", "povray", "-o", "x.npz"],
    ["run", "tiny.txt", "--renderers", "native,povray", "-o", "out"],
    ["doctor", "--renderers", "povray"],
], ids=lambda words: words[0])  # fmt: skip
def test_a_missing_renderer_ends_with_3_and_a_remedy(tmp_path: Path, words: list[str]) -> None:
    """A renderer that is not there is never a pass, and the user learns how to install it."""
    scene_file(tmp_path)
    done = call(*words, cwd=tmp_path, env=NO_POVRAY)
    assert done.returncode == 3
    said = done.stdout + done.stderr
    assert "missing" in said or "not found" in said
    assert "apt-get install povray" in said
    assert "Traceback" not in said
    assert not (tmp_path / "x.npz").exists()


@pytest.mark.parametrize(("does", "said"), [
    ("kill -SEGV $$", "povray"), ("exec sleep 100", "1.5 s"), ("exit 0", "povray"),
], ids=["crashes", "hangs", "writes nothing"])  # fmt: skip
def test_a_renderer_that_fails_ends_with_3_and_says_how(
    tmp_path: Path, does: str, said: str
) -> None:
    """A crash, a hang and an absent image are each told in words, and no file is written."""
    scene_file(tmp_path)
    words = ("render", "tiny.txt", "--with", "povray", "-o", "x.npz", "--timeout", "1.5")
    done = call(*words, cwd=tmp_path, env=fake_povray(tmp_path, does))
    assert done.returncode == 3
    assert said in done.stderr.partition("crosstrace: ")[2]
    assert "Traceback" not in done.stderr
    assert not (tmp_path / "x.npz").exists()


def test_a_lane_without_readings_refuses_them(tmp_path: Path) -> None:
    """Only native takes other readings of the specification; elsewhere no image is made."""
    scene_file(tmp_path)
    words = ("render", "tiny.txt", "--with", "mitsuba-f64", "--set", "tir=ignore", "-o", "x.npz")
    done = call(*words, cwd=tmp_path)
    assert done.returncode == 3
    assert "tir=ignore" in done.stderr
    assert not (tmp_path / "x.npz").exists()


def test_an_edited_record_is_refused_and_the_old_page_stays(tmp_path: Path) -> None:
    """A report.json of the right schema that lacks its parts draws no page."""
    (tmp_path / "report.json").write_text('{"schema": "crosstrace-report/1"}', encoding="ascii")
    (tmp_path / "report.html").write_text("old", encoding="ascii")
    done = call("report", tmp_path / "report.json")
    assert done.returncode == 2
    assert "expected a whole record" in done.stderr
    assert (tmp_path / "report.html").read_text(encoding="ascii") == "old"
