"""`crosstrace translate`: a scene in another renderer's language."""

from __future__ import annotations

from pathlib import Path

import click

from crosstrace.harness.commands import options
from crosstrace.translators.errors import UsageError


@click.command()
@click.argument("scene")
@click.option("--to", "lane", required=True, type=click.Choice(["mitsuba", "mitsuba-f64", "povray"]))
@click.option("-o", "--output", type=click.Path(path_type=Path), metavar="FILE")
@options.scene_options
def command(
    scene: str, lane: str, output: Path | None, delivery: int | None, size: str | None
) -> None:
    """Write SCENE for another renderer, to FILE or to standard output."""
    resolution = options.resolution(size)
    from crosstrace.harness import images, one_image
    from crosstrace.harness.sources import find_one

    source = find_one(scene, delivery=delivery, size=resolution)
    made = one_image.translate(lane, source.scene)
    names = list(made.files)
    if output is None:
        if len(names) > 1:
            raise UsageError(f"{lane} needs {len(names)} files: expected -o FILE")
        click.echo(made.files[names[0]], nl=False)
        return
    # The main file takes the name asked for; others stand beside it under their own.
    targets = [output, *(output.with_name(Path(name).name) for name in names[1:])]
    for target, name in zip(reversed(targets), reversed(names), strict=True):
        text = made.files[name]
        images.write_atomically(target, lambda path, text=text: _fill(path, text))
    click.echo(made.command.replace(names[0], str(output)), err=True)


def _fill(path: Path, text: str) -> None:
    path.write_text(text, encoding="utf-8")
