"""`crosstrace run`: the main job."""

from __future__ import annotations

from pathlib import Path

import click

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
    from crosstrace.harness.session import RunOptions, exit_status, run
    from crosstrace.harness.sources import find

    sources = find(scenes, delivery=delivery, size=resolution)
    with console.progress(quiet or as_json) as observe:
        chosen_options = RunOptions(lanes, jobs=jobs or 0, timeout_s=timeout)
        report = run(sources, output, chosen_options, events=observe)
    if as_json:
        click.echo(record.dumps(report), nl=False)
    elif not quiet:
        console.summary(report)
        click.echo(f"\nReport: {output / 'report.html'}")
    ctx.exit(exit_status(report))
