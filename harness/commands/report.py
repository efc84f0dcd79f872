"""`crosstrace report`: the page again, from its record."""

from __future__ import annotations

from pathlib import Path

import click

from crosstrace.harness.commands import options


@click.command(name="report")
@click.argument("file", type=click.Path(path_type=Path), metavar="FILE")
@click.option("-o", "--output", type=click.Path(path_type=Path), metavar="HTML",
              help="Where to write the page; default: report.html beside FILE.")  # fmt: skip
@options.quiet
def command(file: Path, output: Path | None, quiet: bool) -> None:
    """Draw the page of a report.json; it shows the images that lie beside FILE."""
    from crosstrace.harness import record
    from crosstrace.harness.images import write_atomically
    from crosstrace.harness.page import draw
    from crosstrace.harness.publish import PAGE_NAME
    from crosstrace.translators.errors import UsageError

    report = record.loads(file)
    try:
        text = draw.page(report)
    except (KeyError, TypeError, AttributeError, ValueError) as error:
        raise UsageError(f"{file}: expected a whole report, found: {error!r}") from error
    target = output or file.with_name(PAGE_NAME)
    write_atomically(target, lambda temporary: _write(temporary, text))
    if not quiet:
        click.echo(target)


def _write(path: Path, text: str) -> None:
    path.write_text(text, encoding="utf-8")
