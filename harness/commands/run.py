"""`crosstrace run`: the main job."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from crosstrace.harness import console
from crosstrace.harness.commands import options


@click.command("run")
@click.argument("scenes", nargs=-1, metavar="[SCENE]...")
@click.option("-o", "--output", default="report", show_default=True, metavar="DIR",
              type=click.Path(path_type=Path), help="Where the report goes.")  # fmt: skip
@options.renderers
@options.settings
@options.precision
@options.tolerance
@options.scene_options
@options.threads
@options.timeout
@options.jobs
@options.junit
@options.as_json
@options.quiet
def command(
    scenes: tuple[str, ...],
    output: Path,
    renderers: str | None,
    settings: tuple[str, ...],
    precision: str,
    tolerance: float,
    size: tuple[int, int] | None,
    delivery: int | None,
    threads: int,
    timeout: float,
    jobs: int | None,
    junit: Path | None,
    as_json: bool,
    quiet: bool,
) -> int:
    """Render every SCENE with every renderer, compare every two images, and report.

    Leaves DIR/report.html, DIR/report.md, DIR/report.json and the images. Without a SCENE it takes
    the packaged course scenes, which are this project's own compositions under the course's names.
    The exit status is 1 where a renderer is wrong other than the scene's index expects, 3 where one
    is missing or failed: the rest is in the report.
    """
    from crosstrace.harness import images
    from crosstrace.harness.junit import of_run
    from crosstrace.harness.lanes import chosen
    from crosstrace.harness.outcome import exit_status
    from crosstrace.harness.session import RunOptions, run
    from crosstrace.harness.sources import find
    from crosstrace.translators import readings

    lanes = chosen(renderers)
    if junit is not None:
        options.check_target(junit)
    how = RunOptions(lanes, jobs or 0, threads, timeout, readings.parse(settings), precision,
                     size, tolerance)  # fmt: skip
    sources = find(scenes, delivery=delivery, size=size)
    with console.progress(quiet, f"scenes: {len(sources)}, renderers: {', '.join(lanes)}") as bar:
        report = run(sources, output, how, events=console.observer(bar))
    if junit is not None:
        images.write_bytes(junit, of_run(report))
    if as_json:
        console.json_result(report)
    else:
        _print(report, output, quiet)
    return exit_status(report)


def _print(report: dict[str, Any], output: Path, quiet: bool) -> None:
    from crosstrace.harness import summary

    if not quiet:
        header, rows, numbers = summary.by_scene(report)
        console.table(header, rows, right=numbers)
        console.result("")
        header, rows, numbers = summary.by_lane(report)
        console.table(header, rows, right=numbers)
        console.result("")
    for line in summary.verdicts(report, only_departing=quiet):
        console.result(line)
    for line in summary.failures(report):
        console.result(line)
    if not quiet:
        console.result(f"\nreport: {output / 'report.html'}")
