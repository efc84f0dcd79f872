"""`crosstrace explain`: why a pixel has the value that it has, in every lane."""

from __future__ import annotations

import click

from crosstrace.harness import console
from crosstrace.harness.commands import options


@click.command("explain")
@click.argument("scene")
@click.argument("row", type=int)
@click.argument("col", type=int)
@options.renderers
@options.settings
@options.scene_options
@options.timeout
@options.as_json
@options.quiet
def command(
    scene: str,
    row: int,
    col: int,
    renderers: str | None,
    settings: tuple[str, ...],
    size: tuple[int, int] | None,
    delivery: int | None,
    timeout: float,
    as_json: bool,
    quiet: bool,
) -> int:
    """Explain the pixel of SCENE in ROW and COL, both from 0, row 0 at the top.

    Shows its rays with hits, contributions and the margin to the next decision, the rigorous
    enclosure of its true value, and the value in every lane. The readings of --set are native's.
    The exit status is 3 where a renderer is missing or failed: the rest is shown.
    """
    from crosstrace.harness.cli import OK, RENDERER_FAILED
    from crosstrace.harness.explain import explain
    from crosstrace.harness.explain_text import lines
    from crosstrace.harness.lanes import chosen
    from crosstrace.translators import readings

    lanes = chosen(renderers)
    others = readings.parse(settings)
    source = options.one_scene(scene, delivery, size)
    with console.progress(quiet, f"{source.name} by {', '.join(lanes)}") as bar:
        found = explain(source.scene, row, col, lanes, others, timeout_s=timeout, step=bar.update)
    if as_json:
        console.json_result(found.record())
    else:
        for line in lines(found):
            console.result(line)
    return OK if found.complete else RENDERER_FAILED
