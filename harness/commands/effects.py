"""`crosstrace effects`: what a scene calls for."""

from __future__ import annotations

import click

from crosstrace.harness.commands import options


@click.command(name="effects")
@options.scene
@options.delivery
@options.as_json
def command(scene: str, delivery: int | None, as_json: bool) -> None:
    """Say which effects SCENE calls for, overall and object by object, and what is left out."""
    from crosstrace.harness import console
    from crosstrace.harness.sources import find_one
    from crosstrace.translators.effects import EFFECTS, effects, names

    found = effects(find_one(scene, delivery=delivery).scene)
    by_mask = {mask: list(names(mask)) for mask in set(found.objects.tolist())}
    objects = found.objects.tolist()
    left_out = [name for name in EFFECTS if name not in found.names]
    if as_json:
        listed = [{"index": i, "effects": by_mask[mask]} for i, mask in enumerate(objects)]
        console.print_json(
            {"effects": list(found.names), "left_out": left_out, "objects": listed}
        )
        return
    click.echo(f"effects:  {_listed(list(found.names))}")
    click.echo(f"left out: {_listed(left_out)}")
    rows = [[str(i), _listed(by_mask[mask])] for i, mask in enumerate(objects)]
    if rows:
        click.echo()
        click.echo(console.table(["object", "effects"], rows, left=2))


def _listed(effect_names: list[str]) -> str:
    return ", ".join(effect_names) or "none"
