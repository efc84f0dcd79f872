"""`crosstrace run`: the main job."""

from __future__ import annotations

from pathlib import Path

import click

from crosstrace.harness.cli import RENDERER
from crosstrace.harness.commands import options


@click.command()
@click.argument("scenes", nargs=-1, metavar="[SCENE]...")
@click.option(
    "-o", "--output", default="report", show_default=True, type=click.Path(path_type=Path),
    metavar="DIR", help="Where the report goes.",
)  # fmt: skip
@options.renderers
@options.scene_options
@options.timeout
@click.option(
    "--jobs", type=click.IntRange(min=1), metavar="N", help="Images at a time; default: one a core."
)
@options.json_output
@options.quiet
@click.pass_context
def command(
    ctx: click.Context, scenes: tuple[str, ...], output: Path, renderers: str | None,
    delivery: int | None, size: str | None, timeout: float, jobs: int | None, as_json: bool,
    quiet: bool,
) -> None:  # fmt: skip
    """Render every SCENE with every renderer and compare every two images.

    Leaves DIR/report.html, DIR/report.json and the images. Without a SCENE: the packaged course
    scenes. Ends with status 3 where a renderer is missing or failed; the rest is in the report.
    """
    resolution = options.resolution(size)
    from crosstrace.harness.lanes import chosen

    lanes = chosen(renderers)
    from crosstrace.harness import console, record
    from crosstrace.harness.run import run_sources
    from crosstrace.harness.sources import find

    sources = find(scenes, delivery=delivery, size=resolution)
    with console.progress(quiet or as_json) as observe:
        finished = run_sources(
            sources, lanes, output, jobs=jobs, timeout_s=timeout, observe=observe
        )
    if as_json:
        click.echo(record.dumps(finished.report), nl=False)
    elif not quiet:
        console.summary(finished.report)
        click.echo(f"\nReport: {finished.page}")
    if not record.is_complete(finished.report):
        ctx.exit(RENDERER)
