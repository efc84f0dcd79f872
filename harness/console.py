"""What people see: results on the standard output, progress and notes on the standard error.

On a terminal progress is a bar, elsewhere it is plain lines; both say the stage, the rate and the
time left. Colours stand on terminals only, and never under `NO_COLOR`; nothing is said by colour
alone. Tables are at most 80 columns wide.
"""

from __future__ import annotations

import json
import os
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, TextIO

from crosstrace.harness.pace import Pace

if TYPE_CHECKING:
    from rich.console import Console
    from rich.progress import Progress as RichProgress
    from rich.progress import TaskID

    from crosstrace.harness.schedule import Event

WIDTH = 80

#: Elsewhere than on a terminal, a line of progress no more often than this.
LINE_EVERY_S = 2.0

#: Characters of a bar's words, so that with count, rate and time left they keep within 80 columns.
_STAGE, _WORDS = 10, 24

#: A word of a table → its colour.
STYLES = {"ok": "green", "missing": "red", "failed": "red", "unsupported": "yellow"}


class Bar:
    """Progress that is told in steps; on a terminal a bar, elsewhere lines, quiet: nothing."""

    def __init__(
        self, quiet: bool, rich_bar: RichProgress | None, task: TaskID | None, counted: bool = True
    ) -> None:
        """Take the bar of a terminal; None elsewhere."""
        self._quiet, self._rich, self._task = quiet, rich_bar, task
        self._counted, self._pace = counted, Pace()
        self._last_line_s = time.monotonic()

    def update(
        self, done: float, total: float, text: str = "", failed: bool = False, stage: str = ""
    ) -> None:
        """Show how far the work is, in which stage, and what was last done.

        A failure always gets a line.
        """
        whole = f"{stage} {text}".strip()
        if self._rich is not None and self._task is not None:
            changed = {"description": _cut(text, _WORDS)} if text else {}
            changed |= {"stage": _cut(stage, _STAGE)} if stage else {}
            pace = self._pace.text(done, total, self._counted)
            self._rich.update(self._task, completed=done, total=total, pace=pace, **changed)
            if failed:
                self._rich.console.print(whole, style="red", markup=False, highlight=False)
            return
        now = time.monotonic()
        is_due = failed or done >= total or now - self._last_line_s >= LINE_EVERY_S
        if text and is_due and not self._quiet:
            self._last_line_s = now
            pace = self._pace.text(done, total, self._counted)
            _write(sys.stderr, f"[{done:.0f}/{total:.0f}] {whole}" + (f" ({pace})" if pace else ""))


@contextmanager
def progress(quiet: bool, text: str, counted: bool = True) -> Iterator[Bar]:
    """Show progress while the block runs: `counted` steps, otherwise a percentage."""
    if quiet or not is_terminal(sys.stderr):
        note(text, quiet)
        yield Bar(quiet, None, None, counted)
        return
    from rich.progress import (
        BarColumn,
        MofNCompleteColumn,
        Progress,
        TaskProgressColumn,
        TextColumn,
    )

    count = MofNCompleteColumn() if counted else TaskProgressColumn()
    words = ("{task.fields[stage]}", "{task.fields[pace]}", "{task.description}")
    stage, pace, last = (TextColumn(word, markup=False) for word in words)
    columns = (BarColumn(12), count, pace, stage, last)
    with Progress(*columns, console=_console(sys.stderr), transient=True) as bar:
        total = None if counted else 1.0
        task = bar.add_task(_cut(text, _WORDS), total=total, stage="", pace="")
        yield Bar(quiet, bar, task, counted)


def observer(bar: Bar) -> Callable[[Event], None]:
    """Return what shows the events of a run in a bar."""

    def observe(event: Event) -> None:
        if event.kind != "start":
            part = event.fraction if event.kind == "progress" else 0.0
            words = " ".join(word for word in (event.scene, event.lane) if word)
            text = f"{words}: {event.message}" if event.message else words
            failed = event.kind == "failed"
            bar.update(event.done + part, event.total, text, failed, stage=event.what)

    return observe


def note(text: str, quiet: bool = False) -> None:
    """Write a line for people beside the result."""
    if not quiet:
        _write(sys.stderr, text)


def result(text: str) -> None:
    """Write a line of the result itself."""
    _write(sys.stdout, text)


def json_result(value: Any) -> None:
    """Write a result for programs: JSON in plain ASCII, so that no locale can break it."""
    json.dump(value, sys.stdout, indent=1, allow_nan=False)
    _write(sys.stdout, "")


def table(header: Sequence[str], rows: Sequence[Sequence[str]], right: Sequence[str] = ()) -> None:
    """Print a table on the standard output; the columns in `right` hold numbers."""
    from rich.table import Table
    from rich.text import Text

    console = _console(sys.stdout)
    drawn = Table(box=None, padding=(0, 1, 0, 0), pad_edge=False, header_style="bold")
    for name in header:
        drawn.add_column(name, justify="right" if name in right else "left", overflow="fold")
    for row in rows:
        drawn.add_row(*(Text(cell, style=STYLES.get(cell, "")) for cell in row))
    if is_terminal(sys.stdout):
        console.print(drawn)
        return
    # Without the blanks that pad the last column.
    with console.capture() as captured:
        console.print(drawn)
    for line in captured.get().splitlines():
        _write(sys.stdout, line.rstrip())


def is_terminal(stream: TextIO) -> bool:
    """Whether a stream is a terminal that can move its cursor."""
    return stream.isatty() and os.environ.get("TERM", "") not in ("", "dumb")


def number(value: float | None, digits: int = 2) -> str:
    """Write a number in few characters: 0, 0.034, 3.4e-07; a dash for none."""
    return "-" if value is None else f"{value:.{digits}g}"


def _console(stream: TextIO) -> Console:
    from rich.console import Console

    terminal = is_terminal(stream)
    width = (
        min(WIDTH, os.get_terminal_size(stream.fileno()).columns or WIDTH) if terminal else WIDTH
    )
    return Console(file=stream, width=width, force_terminal=terminal, highlight=False, emoji=False)


def _cut(text: str, length: int) -> str:
    return text if len(text) <= length else text[: length - 1] + "…"


def _write(stream: TextIO, text: str) -> None:
    stream.write(text + "\n")
    stream.flush()
