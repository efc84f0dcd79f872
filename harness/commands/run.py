"""`crosstrace run`: the main job."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from crosstrace.harness.commands import options

if TYPE_CHECKING:
    from collections.abc import Mapping


@click.command(name="run")
@click.argument("scenes", metavar="[SCENE…]", nargs=-1)
@click.option(
    "-o", "--output", type=click.Path(path_type=Path), default=Path("report"), show_default=True,
    metavar="DIR", help="Where report.html, report.json and the images go.",
)  # fmt: skip
@click.option("--renderers", metavar="A,B", help="Only these renderers.")
@click.option("--jobs", type=click.IntRange(1), help="Images at once; default: one a core.")
@options.timeout(300.0)
@options.size
@options.delivery
@options.as_json
@options.quiet
def command(
    scenes: tuple[str, ...],
    output: Path,
    renderers: str | None,
    jobs: int | None,
    timeout_s: float,
    size: tuple[int, int] | None,
    delivery: int | None,
    as_json: bool,
    quiet: bool,
) -> int:
    """Render every SCENE through every renderer, compare all images, write a report.

    No SCENE: the packaged course scenes. Every scene is read before the first is rendered. The exit
    status is 3 where a renderer is missing or failed; the others are reported all the same.
    """
    from crosstrace.harness import console, lanes, record
    from crosstrace.harness.run import run_sources
    from crosstrace.harness.sources import find

    chosen = lanes.chosen(renderers)
    sources = find(scenes, delivery=delivery, size=size)
    with console.events(quiet, f"{len(sources)} scenes") as observe:
        finished = run_sources(
            sources, chosen, output, jobs=jobs, timeout_s=timeout_s, observe=observe
        )
    if as_json:
        console.print_json(finished.report)
    else:
        click.echo(_table(finished.report))
        _echo_troubles(finished.report)
        click.echo(f"report: {finished.page}")
    return 0 if record.is_complete(finished.report) else 3


def _table(report: Mapping[str, Any]) -> str:
    """Return each scene's numbers against the first renderer."""
    from crosstrace.harness.console import table
    from crosstrace.harness.page.draw import significant, similarity

    head = ["scene", "verdict", "a", "b", "max", "> 1/255", "> 1e-4", "> 1e-9", "SSIM"]
    rows = []
    for scene in report["scenes"]:
        for pair in scene["pairs"]:
            if pair["a"] == report["run"]["lanes"][0]:
                counts = [pair[key] for key in ("over_1_255", "over_1e_4", "over_1e_9")]
                rows.append(
                    [scene["name"], scene["verdict"] or "–", pair["a"], pair["b"],
                     significant(pair["max"]),
                     *("–" if n is None else str(n) for n in counts),
                     similarity(pair["ssim"])]
                )  # fmt: skip
    if not rows:
        rows = [
            [scene["name"], scene["verdict"] or "–", entry["name"], *"––––––"]
            for scene in report["scenes"]
            for entry in scene["renderers"]
        ]
    return table(head, rows, left=4)


def _echo_troubles(report: Mapping[str, Any]) -> None:
    told: dict[tuple[str, str, str], list[str]] = {}
    for scene in report["scenes"]:
        for entry in scene["renderers"]:
            if entry["status"] != "ok":
                key = (entry["name"], entry["status"], entry["message"])
                told.setdefault(key, []).append(scene["name"])
    for (lane, status, message), names in told.items():
        where = f"{len(names)} scenes" if len(names) > 3 else ", ".join(names)
        click.echo(f"{lane} {status} on {where}: {message}", err=True)
