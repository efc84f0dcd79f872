"""The README's commands are the ones that work."""

from __future__ import annotations

import os
import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
README = (ROOT / "README.md").read_text(encoding="utf-8")
SCENE = "24 32 0.05 1 0 -6 1.5 0 0 0.8 0 0 1 120 170 230 1 230 60 60 * 0 0 1 1\n"


def blocks(language: str, section: str) -> list[str]:
    """Return the code blocks of one language under one heading."""
    text = re.search(rf"^## {re.escape(section)}\n(.*?)(?=^## |\Z)", README, re.M | re.S)
    assert text, f"the README has no section {section!r}"
    return re.findall(rf"^```{language}\n(.*?)^```", text[1], re.M | re.S)


def run(words: list[str], folder: Path) -> None:
    done = subprocess.run(
        words, cwd=folder, capture_output=True, text=True, timeout=300, check=False,
        env=os.environ | {"PYTHONPATH": ""},
    )  # fmt: skip
    assert done.returncode == 0, f"{words}\n{done.stdout}\n{done.stderr}"


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Return a folder with the files that the README's examples name."""
    (tmp_path / "my-scenes").mkdir()
    for name in ("scene.txt", "my-scenes/one.txt", "my-scenes/two.txt"):
        (tmp_path / name).write_text(SCENE)
    return tmp_path


def test_the_command_lines_run_as_they_stand(folder: Path) -> None:
    """Each line of the shell example succeeds, one after the other."""
    (text,) = blocks("sh", "Ten lines of use")
    lines = [shlex.split(line, comments=True) for line in text.splitlines() if line]
    assert len(lines) >= 8
    for words in lines:
        assert words[0] == "crosstrace"
        run([sys.executable, "-m", *words], folder)
    assert (folder / "report/report.html").is_file()


def test_the_python_example_runs_as_it_stands(folder: Path) -> None:
    """The ten lines of Python succeed as a plain script, without a `__main__` guard."""
    (text,) = blocks("python", "Ten lines of use")
    (folder / "example.py").write_text(text)
    run([sys.executable, "example.py"], folder)


def test_there_are_exactly_two_commands_and_ci_installs_the_same_packages() -> None:
    """What the first command installs through apt, CI installs too, and nothing less."""
    first, second = blocks("sh", "Two commands")
    assert len(first.splitlines()) == len(second.splitlines()) == 1
    packages = re.search(r"apt-get install -y ([a-z0-9 -]+?) &&", first)
    assert packages
    ci = (ROOT / ".ci/run").read_text(encoding="utf-8")
    assert set(packages[1].split()) <= set(ci.split())
    assert "pip install '.[test]'" in second and second.rstrip().endswith("pytest")


def test_every_file_that_the_readme_names_exists() -> None:
    """Paths in code spans that begin with a part's folder are there."""
    named = set(re.findall(r"`((?:native|translators|harness|scenes)/[\w./-]+)`", README))
    missing = [name for name in named if not (ROOT / name).exists()]
    assert named and not missing
    assert (ROOT / ".github/report.png").is_file()
