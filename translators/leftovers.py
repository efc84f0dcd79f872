"""Temporary folders that outlived their process.

A process that is killed outright removes nothing. What it left goes when the next folder of its
kind is made: only a real folder of this user, with a name that `tempfile` gives, in whose whole
tree nothing has been written for a week. No work in progress is that quiet.
"""

from __future__ import annotations

import os
import re
import shutil
import time
from pathlib import Path

#: Nothing may have been written for so long.
QUIET_S = 7 * 24 * 3600.0


def sweep(home: Path, prefix: str) -> None:
    """Remove from `home` what `tempfile.mkdtemp(prefix=prefix, dir=home)` made and nobody removed.

    What cannot be looked at or removed stays.
    """
    name = re.compile(re.escape(prefix) + r"[a-z0-9_]{8}")
    try:
        folders = [Path(entry) for entry in os.scandir(home) if name.fullmatch(entry.name)]
    except OSError:
        return
    for folder in folders:
        if _is_left_over(folder):
            shutil.rmtree(folder, ignore_errors=True)


def _is_left_over(folder: Path) -> bool:
    before = time.time() - QUIET_S
    try:
        found = folder.lstat()
        mine = folder.is_dir() and not folder.is_symlink() and found.st_uid == os.getuid()
        return (
            mine
            and found.st_mtime < before
            and all(path.lstat().st_mtime < before for path in folder.rglob("*"))
        )
    except OSError:
        return False
