"""What a killed process left behind goes, and nothing else does."""

from __future__ import annotations

import os
import tempfile
import time
from pathlib import Path

import pytest

from crosstrace.translators import leftovers
from crosstrace.translators.leftovers import QUIET_S, sweep

PREFIX = "crosstrace-thing-"


def aged(folder: Path, seconds: float) -> None:
    """Say that nothing has been written to a folder for so long."""
    for path in (*folder.rglob("*"), folder):
        then = time.time() - seconds
        os.utime(path, (then, then))


def made(home: Path) -> Path:
    folder = Path(tempfile.mkdtemp(prefix=PREFIX, dir=home))
    (folder / "inner").mkdir()
    (folder / "inner/file").write_text("old", encoding="utf-8")
    return folder


def test_what_was_quiet_for_a_week_goes(tmp_path: Path) -> None:
    """With all that is in it."""
    left, young = made(tmp_path), made(tmp_path)
    aged(left, QUIET_S + 60)
    aged(young, QUIET_S - 600)
    sweep(tmp_path, PREFIX)
    assert list(tmp_path.iterdir()) == [young]


def test_an_old_folder_in_which_somebody_works_stays(tmp_path: Path) -> None:
    """One file written of late, however deep, is a sign of life."""
    busy = made(tmp_path)
    aged(busy, QUIET_S + 60)
    (busy / "inner/file").write_text("new", encoding="utf-8")
    sweep(tmp_path, PREFIX)
    assert (busy / "inner/file").exists()


def test_what_was_not_made_here_stays(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Not files, links, other names, or another user's folders; no folder at all is no error."""
    home, elsewhere = tmp_path / "home", tmp_path / "elsewhere"
    for folder in (home / f"{PREFIX}notes", home / f"my-{PREFIX}abcdefgh", elsewhere):
        folder.mkdir(parents=True)
        aged(folder, QUIET_S + 60)
    (home / f"{PREFIX}abcdefgh").symlink_to(elsewhere)
    (home / f"{PREFIX}ijklmnop").write_text("a file", encoding="utf-8")
    aged(home / f"{PREFIX}ijklmnop", QUIET_S + 60)
    before = sorted(home.iterdir())
    sweep(home, PREFIX)
    assert sorted(home.iterdir()) == before
    sweep(tmp_path / "nowhere", PREFIX)
    other = made(home)
    aged(other, QUIET_S + 60)
    monkeypatch.setattr(leftovers.os, "getuid", lambda: os.geteuid() + 1)
    sweep(home, PREFIX)
    assert other.exists()
