"""`crosstrace report`: the page of a record, drawn again."""

from __future__ import annotations

from functools import partial
from pathlib import Path

import click

from crosstrace.harness import console
from crosstrace.harness.commands import options


@click.command("report")
@click.argument("file", type=click.Path(path_type=Path), metavar="REPORT.JSON")
@click.option("-o", "--output", type=click.Path(path_type=Path), metavar="FILE",
              help="Default: report.html beside the record, where its images are.")  # fmt: skip
@options.quiet
def command(file: Path, output: Path | None, quiet: bool) -> None:
    """Draw the page of REPORT.JSON again."""
    from crosstrace.harness import images, record

    target = output or file.with_name("report.html")
    options.check_target(target)
    html = _draw(record.loads(file), file)
    images.write_atomically(target, partial(_save, text=html))
    console.note(f"report: {target}", quiet)


def _draw(report: dict[str, object], file: Path) -> str:
    import jinja2

    from crosstrace.harness.page import draw
    from crosstrace.translators.errors import UsageError

    try:
        return draw.page(report, file.parent)
    except (jinja2.TemplateError, LookupError, TypeError, ValueError, AttributeError) as error:
        # The page trusts the record; a file that says it is one may have been edited.
        raise UsageError(f"{file}: expected a whole record, found: {error!r}") from error


def _save(path: Path, text: str) -> None:
    path.write_bytes(text.encode())
