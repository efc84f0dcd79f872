"""`crosstrace check` and `bless` as a user calls them."""

from __future__ import annotations

import json
from pathlib import Path
from xml.etree import ElementTree

import pytest
from command_line import NO_POVRAY, SCENE, call, scene_file

LANES = ("--renderers", "native,povray")


def suite(folder: Path) -> tuple[str, ...]:
    """Make a folder with a scene and its golden; return the words that name it."""
    (folder / "suite").mkdir()
    scene_file(folder / "suite")
    words = ("--reference", "suite", *LANES)
    done = call("bless", "--all", *words, "--reason", "as drawn by two renderers", cwd=folder)
    assert done.returncode == 0, done.stderr
    assert "tiny: new, " in done.stdout
    return words


def test_a_suite_of_ones_own_is_blessed_checked_and_told_when_it_changes(tmp_path: Path) -> None:
    """Scenes and goldens in one folder: 0 as long as all is as it was, 1 for another scene."""
    words = suite(tmp_path)
    assert sorted(p.name for p in (tmp_path / "suite").iterdir()) == [
        "VERDICTS.md", "tiny.json", "tiny.npz", "tiny.txt",
    ]  # fmt: skip
    files = ("--junit", "junit.xml", "-o", "report", "--json")
    done = call("check", *words, *files, cwd=tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr
    record = json.loads(done.stdout)
    assert record == json.loads((tmp_path / "report/check.json").read_text())
    assert (record["status"], record["scenes"][0]["status"]) == ("pass", "pass")
    assert record["scenes"][0]["reason"] == "as drawn by two renderers"
    assert (tmp_path / "report/report.html").is_file()
    assert ElementTree.parse(tmp_path / "junit.xml").getroot().get("tests") == "3"
    again = call("bless", "--all", *words, "--reason", "again", cwd=tmp_path)
    assert "tiny: unchanged" in again.stdout

    scene_file(tmp_path / "suite", SCENE.replace("3 -4 6", "3 -4 6.001"))
    done = call("check", *words, cwd=tmp_path)
    assert done.returncode == 1
    assert "tiny: fail\n  the golden is of another scene" in done.stdout
    assert done.stdout.endswith("1 scenes: 0 pass, 1 fail\n")


def test_a_missing_renderer_ends_a_check_with_3(tmp_path: Path) -> None:
    """It is told with its remedy, and blessing without it is refused."""
    words = suite(tmp_path)
    done = call("check", *words, cwd=tmp_path, env=NO_POVRAY)
    assert done.returncode == 3
    assert "tiny: incomplete\n  povray missing: " in done.stdout
    assert "apt-get install" in done.stdout
    done = call("bless", "--all", *words, "--reason", "no", cwd=tmp_path, env=NO_POVRAY)
    assert done.returncode == 3
    assert "tiny: incomplete, left as it was. povray missing" in done.stdout


def test_a_missing_golden_ends_with_1_and_is_there_afterwards(tmp_path: Path) -> None:
    """The message says what to do with it."""
    scene_file(tmp_path)
    words = ("check", "tiny.txt", "--reference", "goldens", "--renderers", "native")
    done = call(*words, cwd=tmp_path)
    assert done.returncode == 1
    assert "there was no golden: one was made" in done.stdout
    assert call(*words, "-q", cwd=tmp_path).stdout == "1 scenes: 1 pass, 0 fail\n"


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["check", "tiny.txt"], "--reference"),
        (["check", "--reference", "nowhere"], "nowhere"),
        (["check", "--reference", "tiny.txt"], "tiny.txt"),
        (["check", "tiny.txt", "--reference", "goldens", "--junit", "nowhere/x.xml"], "nowhere"),
        (["bless", "tiny.txt", "--reference", "goldens"], "--reason"),
        (["bless", "tiny.txt", "--reference", "goldens", "--reason", "  "], "found nothing"),
        (["bless", "--reference", "goldens", "--reason", "so"], "--all"),
        (["bless", "tiny.txt", "--all", "--reference", "goldens", "--reason", "so"], "--all"),
        (["bless", "tiny.txt", "--reason", "so"], "--reference"),
    ],
    ids=lambda words: " ".join(words) if isinstance(words, list) else "",
)
def test_wrong_usage_ends_with_2_and_leaves_nothing(
    tmp_path: Path, words: list[str], said: str
) -> None:
    """Before anything is rendered."""
    scene_file(tmp_path)
    done = call(*words, cwd=tmp_path)
    assert done.returncode == 2, done.stdout
    assert said in done.stderr and "Traceback" not in done.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["tiny.txt"]


def test_a_users_own_file_is_never_overwritten(tmp_path: Path) -> None:
    """An image of the same name beside the scene is no golden."""
    scene_file(tmp_path)
    (tmp_path / "tiny.npz").write_text("mine")
    words = ("tiny.txt", "--reference", ".", "--renderers", "native")
    for done in (
        call("check", *words, cwd=tmp_path),
        call("bless", *words, "--reason", "so", cwd=tmp_path),
    ):
        assert done.returncode == 2 and "tiny.npz: expected" in done.stderr
    assert (tmp_path / "tiny.npz").read_text() == "mine"
