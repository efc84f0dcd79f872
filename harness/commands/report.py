"""`crosstrace report`: the page of a record, drawn again."""

from __future__ import annotations

from pathlib import Path

import click


@click.command()
@click.argument("file", type=click.Path(path_type=Path), metavar="REPORT.JSON")
def command(file: Path) -> None:
    """Draw the page beside REPORT.JSON again."""
    from crosstrace.harness import images, record
    from crosstrace.harness.page import draw

    html = draw.page(record.loads(file))
    target = file.with_name("report.html")
    images.write_atomically(target, lambda path: _fill(path, html))
    click.echo(f"Report: {target}")


def _fill(path: Path, text: str) -> None:
    path.write_text(text, encoding="utf-8")
