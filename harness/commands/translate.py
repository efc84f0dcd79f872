"""`crosstrace translate`: a scene in another renderer's own language."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import click

from crosstrace.harness import console
from crosstrace.harness.commands import options

if TYPE_CHECKING:
    from crosstrace.translators.renderer import Translation


@click.command("translate")
@click.argument("scene")
@click.option("--to", "lane", required=True, metavar="RENDERER",
              help="mitsuba, mitsuba-f64, povray, or native for the course's format.")  # fmt: skip
@click.option("-o", "--output", type=click.Path(path_type=Path),
              help="A file instead of the standard output.")  # fmt: skip
@options.scene_options
@options.quiet
def command(
    scene: str,
    lane: str,
    output: Path | None,
    size: tuple[int, int] | None,
    delivery: int | None,
    quiet: bool,
) -> None:
    """Write SCENE in a renderer's own language, and say how to render that."""
    from crosstrace.harness import alone

    lane = options.one_lane(lane)
    if output is not None:
        options.check_target(output)
    found = options.one_scene(scene, delivery, size).scene
    if output is not None:
        # What the text says about its own file is then true.
        found = replace(found, name=output.stem)
    translation = alone.translate(lane, found)
    if output is None:
        _print(translation)
    else:
        _write(translation, output)
    main = next(iter(translation.files))
    line = translation.command.replace(main, output.name) if output else translation.command
    console.note(f"render it with: {line}", quiet)


def _print(translation: Translation) -> None:
    from crosstrace.translators.errors import UsageError

    if len(translation.files) > 1:
        names = ", ".join(translation.files)
        raise UsageError(f"expected a file name (-o) for a translation of several files: {names}")
    for text in translation.files.values():
        console.result(text.removesuffix("\n"))


def _write(translation: Translation, output: Path) -> None:
    """Write the main file as `output` and any others beside it, under their own names."""
    from crosstrace.harness.images import write_bytes

    for i, (name, text) in enumerate(translation.files.items()):
        target = output if i == 0 else output.with_name(Path(name).name)
        write_bytes(target, text.encode())
