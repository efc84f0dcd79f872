"""`crosstrace translate`: a scene in another renderer's own language."""

from __future__ import annotations

from pathlib import Path

import click

from crosstrace.harness.commands import options


@click.command(name="translate")
@options.scene
@click.option("--to", "lane", required=True, metavar="LANE", help="mitsuba, povray, …")
@click.option("-o", "--output", type=click.Path(path_type=Path), metavar="FILE",
              help="Where to write it; default: standard output.")  # fmt: skip
@options.settings
@options.size
@options.delivery
@options.quiet
def command(
    scene: str,
    lane: str,
    output: Path | None,
    settings: tuple[str, ...],
    size: tuple[int, int] | None,
    delivery: int | None,
    quiet: bool,
) -> None:
    """Write SCENE in the language of another renderer, and say how to render it there."""
    from crosstrace.harness import api, lanes, one_image
    from crosstrace.harness.images import write_atomically
    from crosstrace.harness.sources import find_one
    from crosstrace.translators.errors import UsageError
    from crosstrace.translators.renderer import RenderOptions

    (lane,) = lanes.chosen([lane])
    _, readings = one_image.readings(settings)
    source = find_one(scene, delivery=delivery, size=size)
    made = api.translate(source.scene, lane, RenderOptions(readings=readings))
    main, *others = made.files
    if output is None:
        if others:
            raise UsageError(f"expected -o FILE: {lane} needs {1 + len(others)} files")
        click.echo(made.files[main], nl=False)
        return
    texts = {output: made.files[main]}
    # A renderer names its files; where they go is the user's choice alone.
    texts |= {output.with_name(Path(name).name): made.files[name] for name in others}
    if len(texts) < len(made.files):
        raise UsageError(f"{output}: expected a name other than those of the files beside it")
    for path, text in texts.items():
        write_atomically(path, lambda temporary, text=text: _write(temporary, text))
    if not quiet:
        click.echo(made.command.replace(main, str(output)))


def _write(path: Path, text: str) -> None:
    path.write_text(text, encoding="utf-8")
