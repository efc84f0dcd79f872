"""Output for people: lines, tables, a progress bar on a terminal and plain lines elsewhere."""

from __future__ import annotations

import contextlib
import os
import sys
from collections.abc import Callable, Iterator, Sequence
from typing import Any

import click

from crosstrace.harness.session import Event


def print_json(value: Any) -> None:
    """Print a JSON text to standard output."""
    from crosstrace.harness import record

    click.echo(record.dumps(value), nl=False)


def table(head: Sequence[str], rows: Sequence[Sequence[str]], left: int = 1) -> str:
    """Return aligned columns, the first `left` of them to the left, without trailing blanks."""
    lines = [list(head), *map(list, rows)]
    widths = [max(len(line[i]) for line in lines) for i in range(len(head))]
    return "\n".join(
        "  ".join(
            cell.ljust(width) if i < left else cell.rjust(width)
            for i, (cell, width) in enumerate(zip(line, widths, strict=True))
        ).rstrip()
        for line in lines
    )


@contextlib.contextmanager
def events(quiet: bool, what: str) -> Iterator[Callable[[Event], None]]:
    """Give a function that shows each Event: on a terminal a bar, elsewhere a line on stderr."""
    if quiet:
        yield lambda event: None
        return
    if not sys.stderr.isatty():
        yield _plain_line
        return
    with _bar() as bar:
        job = bar.add_task(what, total=None)

        def show(event: Event) -> None:
            if event.failed:
                bar.console.print(event.text, style="red", markup=False, highlight=False)
            bar.update(job, completed=event.done, total=event.total)

        yield show


@contextlib.contextmanager
def fraction(quiet: bool, what: str) -> Iterator[Callable[[float], None] | None]:
    """Give a function that shows the fraction done of one job, on a terminal; None elsewhere."""
    if quiet or not sys.stderr.isatty():
        yield None
        return
    with _bar() as bar:
        job = bar.add_task(what, total=1.0)
        yield lambda done: bar.update(job, completed=done)


def _plain_line(event: Event) -> None:
    click.echo(f"[{event.done}/{event.total}] {event.text}", err=True)


def _bar() -> Any:
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

    return Progress(
        TextColumn("{task.description}", markup=False),
        BarColumn(bar_width=None),
        TextColumn("{task.percentage:>3.0f} %"),
        TimeElapsedColumn(),
        console=Console(stderr=True, no_color="NO_COLOR" in os.environ or None),
        transient=True,
    )
