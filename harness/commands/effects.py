"""`crosstrace effects`: what a scene calls for, and what is left out."""

from __future__ import annotations

import click

from crosstrace.harness.commands import options


@click.command()
@click.argument("scene")
@options.readings
@options.delivery
@options.json_output
def command(
    scene: str, settings: tuple[str, ...], delivery: int | None, as_json: bool
) -> None:
    """Say which effects SCENE calls for, object by object."""
    from crosstrace.harness import console, record
    from crosstrace.harness.sources import find_one
    from crosstrace.translators import readings
    from crosstrace.translators.effects import EFFECTS, effects, names

    source = find_one(scene, delivery=delivery)
    called_for = effects(source.scene, readings.parse(settings))
    found = {
        "scene": source.name,
        "sha256": source.scene.sha256,
        "effects": list(called_for.names),
        "left_out": [name for name in EFFECTS if name not in called_for.names],
        "objects": [
            {"index": i, "effects": list(names(int(mask)))}
            for i, mask in enumerate(called_for.objects)
        ],
    }
    if as_json:
        click.echo(record.dumps(found), nl=False)
    else:
        console.effects(found, source.scene.is_sphere.tolist())
