"""`crosstrace report`: the page of a record, or its summary, drawn again."""

from __future__ import annotations

from pathlib import Path

import click

from crosstrace.harness import console
from crosstrace.harness.commands import options


@click.command("report")
@click.argument("file", type=click.Path(path_type=Path), metavar="REPORT.JSON")
@click.option("-o", "--output", type=click.Path(path_type=Path), metavar="FILE",
              help="Default: report.html beside the record; Markdown: printed.")  # fmt: skip
@click.option("--markdown", is_flag=True, help="The summary for a pull request, not the page.")
@options.quiet
def command(file: Path, output: Path | None, markdown: bool, quiet: bool) -> None:
    """Draw the page of REPORT.JSON again, from it and the files beside it that it names.

    A file that is missing, or not the one that the record names by its hash, is told on the page.
    """
    from crosstrace.harness import images, record

    target = output or (None if markdown else file.with_name("report.html"))
    if target is not None:
        options.check_target(target)
    text = _draw(record.loads(file), file, markdown)
    if target is None:
        console.result(text.rstrip("\n"))
        return
    images.write_bytes(target, text.encode())
    console.note(f"report: {target}", quiet)


def _draw(report: dict[str, object], file: Path, markdown: bool) -> str:
    import jinja2

    from crosstrace.harness import markdown as summary
    from crosstrace.harness.page import draw
    from crosstrace.translators.errors import UsageError

    try:
        return summary.document(report) if markdown else draw.page(report, file.parent)
    except (jinja2.TemplateError, LookupError, TypeError, ValueError, AttributeError) as error:
        # Both trust the record; a file that says it is one may have been edited.
        raise UsageError(f"{file}: expected a whole record, found: {error!r}") from error
