"""Calls the command as a user does, in a process of its own."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path
from typing import Any

COMMAND = [sys.executable, "-m", "crosstrace"]

#: A red sphere over a mirror, 12 x 16 pixels, delivery 3.
SCENE = """12 16
0.06 1
0 -5 1  0 0 1  0 0 1
10 20 30
1
2
255 0 0  0.1 0.7 0.3 20 0 0 1 * 0 0 1 1
200 200 200  0.1 0.5 0 1 0.4 0 1 / 0 0 0 0 0 1
255 255 255
1
255 255 255  3 -4 6
"""

NO_POVRAY = {"CROSSTRACE_POVRAY": "/nonexistent"}


def environment(changes: dict[str, str] | None = None) -> dict[str, str]:
    """Return this process's environment without what steers terminals, and with some changes."""
    plain = {k: v for k, v in os.environ.items() if k not in ("NO_COLOR", "FORCE_COLOR", "COLUMNS")}
    # The fake renderers stand beside this file.
    plain["PYTHONPATH"] = os.pathsep.join([str(Path(__file__).parent), *sys.path])
    return {**plain, **(changes or {})}


def call(
    *words: object, cwd: Path | None = None, env: dict[str, str] | None = None, **more: Any
) -> subprocess.CompletedProcess[str]:
    """Run `crosstrace` with some words and return its status and its output."""
    return subprocess.run(
        [*COMMAND, *map(str, words)],
        cwd=cwd, env=environment(env), capture_output=True, text=True, check=False,
        timeout=240, **more,
    )  # fmt: skip


def python(
    program: str, *, cwd: Path | None = None, from_input: bool = False
) -> subprocess.CompletedProcess[str]:
    """Run a program without a main guard, as a text on the command line or from standard input."""
    words = ["-"] if from_input else ["-c", program]
    return subprocess.run(
        [sys.executable, *words], input=program if from_input else None,
        cwd=cwd, env=environment(), capture_output=True, text=True, check=False, timeout=240,
    )  # fmt: skip


def fake_povray(folder: Path, does: str) -> dict[str, str]:
    """Return an environment whose POV-Ray states its version, else does what a shell line says."""
    program = folder / "fake-povray"
    states = 'case "$*" in *--version*) echo "POV-Ray 3.7.0.10" >&2; exit 0;; esac'
    program.write_text(f"#!/bin/sh\n{states}\n{does}\n", encoding="ascii")
    program.chmod(0o755)
    return {"CROSSTRACE_POVRAY": str(program)}


def scene_file(folder: Path, text: str = SCENE, name: str = "tiny.txt") -> Path:
    """Write a scene and return its file."""
    path = folder / name
    path.write_text(text, encoding="ascii")
    return path
