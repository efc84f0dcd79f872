"""A report's directory: built apart, then put in place, so that it is never half-written.

Files of an earlier report that the new one lacks are removed; any other file in the directory is
left alone.
"""

from __future__ import annotations

import contextlib
import shutil
import tempfile
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from crosstrace.harness import markdown, record
from crosstrace.harness.page import draw
from crosstrace.translators.errors import UsageError
from crosstrace.translators.leftovers import sweep

JSON_NAME, PAGE_NAME, MARKDOWN_NAME = "report.json", "report.html", "report.md"

_PREFIX = ".crosstrace-report-"


@contextlib.contextmanager
def workspace(directory: Path) -> Iterator[Path]:
    """Give a private directory on the file system of `directory`; it is gone afterwards.

    Raises UsageError where the report could not be put in place later.
    """
    if directory.exists() and not directory.is_dir():
        raise UsageError(f"{directory}: expected a directory, found a file")
    home = directory if directory.is_dir() else directory.absolute().parent
    try:
        home.mkdir(parents=True, exist_ok=True)
        sweep(home, _PREFIX)
        made = Path(tempfile.mkdtemp(prefix=_PREFIX, dir=home))
    except OSError as error:
        raise UsageError(f"{directory}: cannot be written: {error.strerror}") from error
    try:
        yield made
    finally:
        shutil.rmtree(made, ignore_errors=True)


def publish(built: Path, directory: Path, report: Mapping[str, Any]) -> Path:
    """Move the images of `built` to `directory`, write record, page and summary; return
    the page's path.
    """
    page = draw.page(report, built)
    try:
        directory.mkdir(parents=True, exist_ok=True)
        stale = _files_of(directory / JSON_NAME)
        (built / JSON_NAME).write_text(record.dumps(report), encoding="utf-8")
        (built / PAGE_NAME).write_text(page, encoding="utf-8")
        (built / MARKDOWN_NAME).write_text(markdown.document(report), encoding="utf-8")
        # The images first: a page must never point at what is not there yet.
        images = sorted(p for p in (built / "images").rglob("*") if p.is_file())
        inside = [image.relative_to(built) for image in images]
        for name in (*inside, Path(PAGE_NAME), Path(MARKDOWN_NAME), Path(JSON_NAME)):
            target = directory / name
            target.parent.mkdir(parents=True, exist_ok=True)
            (built / name).replace(target)
        for name in stale - set(inside):
            _remove(directory, name)
    except OSError as error:
        raise UsageError(f"{directory}: cannot be written: {error.strerror}") from error
    return directory / PAGE_NAME


def _files_of(path: Path) -> set[Path]:
    """Return the images that an earlier report in the same place says are its own."""
    try:
        earlier = record.loads(path)
        entries = [e for s in earlier["scenes"] for e in (s, *s["renderers"], *s["pairs"])]
        images = [image for entry in entries for image in entry.get("images", {}).values()]
        names = [Path(image["file"]) for image in images]
    except (UsageError, KeyError, TypeError, AttributeError):
        return set()
    return {n for n in names if n.parts[:1] == ("images",) and ".." not in n.parts}


def _remove(directory: Path, name: Path) -> None:
    (directory / name).unlink(missing_ok=True)
    with contextlib.suppress(OSError):
        (directory / name).parent.rmdir()
