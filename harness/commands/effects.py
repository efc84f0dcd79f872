"""`crosstrace effects`: what a scene calls for, object by object, and what is left out."""

from __future__ import annotations

from itertools import groupby
from typing import TYPE_CHECKING

import click

from crosstrace.harness import console
from crosstrace.harness.commands import options

if TYPE_CHECKING:
    from crosstrace.translators.effects import SceneEffects
    from crosstrace.translators.scene import Scene

#: A table of more runs of equal objects than this is cut; JSON has them all.
_MOST_ROWS = 200


@click.command("effects")
@click.argument("scene")
@options.settings
@options.scene_options
@options.as_json
def command(
    scene: str,
    settings: tuple[str, ...],
    size: tuple[int, int] | None,
    delivery: int | None,
    as_json: bool,
) -> None:
    """Say which effects SCENE calls for, and which are therefore left out."""
    from crosstrace.translators.effects import EFFECTS, effects, names

    _, readings = options.split_settings(settings)
    source = options.one_scene(scene, delivery, size)
    called_for = effects(source.scene, readings)
    left_out = [name for name in EFFECTS if name not in called_for.names]
    if not as_json:
        _print(source.name, source.scene, called_for, left_out)
        return
    texts = {mask: list(names(mask)) for mask in set(called_for.objects.tolist())}
    kinds = source.scene.is_sphere.tolist()
    console.json_result(
        {
            "name": source.name,
            "sha256": source.scene.sha256,
            "delivery": source.scene.delivery,
            "effects": list(called_for.names),
            "left_out": left_out,
            "objects": [
                {"index": i, "kind": _kind(kinds[i]), "effects": texts[mask]}
                for i, mask in enumerate(called_for.objects.tolist())
            ],
        }
    )


def _print(name: str, scene: Scene, called_for: SceneEffects, left_out: list[str]) -> None:
    from crosstrace.translators.effects import names

    console.result(f"{name}: delivery {scene.delivery}, depth {scene.max_depth}, "
                   f"objects: {len(scene)}, lights: {scene.n_lights}")  # fmt: skip
    console.result(f"calls for: {', '.join(called_for.names) or 'nothing'}")
    console.result(f"left out:  {', '.join(left_out) or 'nothing'}")
    of_each = zip(scene.is_sphere.tolist(), called_for.objects.tolist(), strict=True)
    runs = [(key, len(list(group))) for key, group in groupby(of_each)]
    rows, first = [], 0
    for (is_sphere, mask), count in runs[:_MOST_ROWS]:
        index = str(first) if count == 1 else f"{first}-{first + count - 1}"
        rows.append((index, _kind(is_sphere), ", ".join(names(mask)) or "nothing"))
        first += count
    if rows:
        console.result("")
        console.table(("object", "kind", "effects"), rows, right=("object",))
    if len(runs) > _MOST_ROWS:
        console.result(f"... objects {first} to {len(scene) - 1}: --json lists them all")


def _kind(is_sphere: bool) -> str:
    return "sphere" if is_sphere else "plane"
