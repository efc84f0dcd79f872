"""`crosstrace effects`: what a scene calls for, object by object, and what is left out."""

from __future__ import annotations

from itertools import groupby
from typing import TYPE_CHECKING, Any

import click

from crosstrace.harness import console
from crosstrace.harness.commands import options

if TYPE_CHECKING:
    from crosstrace.harness.sources import Source
    from crosstrace.translators.effects import SceneEffects
    from crosstrace.translators.scene import Scene

#: A table of more runs of equal objects than this is cut; JSON has them all.
_MOST_ROWS = 200


@click.command("effects")
@click.argument("scene")
@click.option("--prove", is_flag=True, help="Render with and without what is left out: the "
              "images must be the same; say what it saves.")  # fmt: skip
@click.option("--repeat", type=click.IntRange(1), default=3, show_default=True,
              help="Runs of --prove, of which times are medians.")  # fmt: skip
@options.renderers
@options.settings
@options.scene_options
@options.threads
@options.timeout
@options.as_json
@options.quiet
def command(
    scene: str,
    prove: bool,
    repeat: int,
    renderers: str | None,
    settings: tuple[str, ...],
    size: tuple[int, int] | None,
    delivery: int | None,
    threads: int,
    timeout: float,
    as_json: bool,
    quiet: bool,
) -> int:
    """Say which effects SCENE calls for, and which are therefore left out.

    With --prove every renderer draws SCENE with and without them. The exit status is 1 where the
    images differ, 3 where a renderer is missing or failed.
    """
    from crosstrace.translators.effects import EFFECTS, effects, names
    from crosstrace.translators.errors import UsageError

    _, readings = options.split_settings(settings)
    if prove and readings:
        raise UsageError("--prove: expected no --set, as most renderers take the defaults only")
    source = options.one_scene(scene, delivery, size)
    called_for = effects(source.scene, readings)
    left_out = [name for name in EFFECTS if name not in called_for.names]
    proof = _prove(source, renderers, repeat, threads, timeout, quiet) if prove else []
    if not as_json:
        _print(source.name, source.scene, called_for, left_out)
        _print_proof(proof)
        return _status(proof)
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
        | (_proof_record(proof) if prove else {})
    )
    return _status(proof)


def _prove(
    source: Source, renderers: str | None, repeat: int, threads: int, timeout: float, quiet: bool
) -> list[dict[str, Any]]:
    from crosstrace.harness.lanes import chosen
    from crosstrace.harness.proof import prove
    from crosstrace.translators.renderer import RenderOptions

    lanes, how = chosen(renderers), RenderOptions(threads, timeout_s=timeout)
    with console.progress(quiet, f"{source.name} with and without", counted=False) as bar:

        def told(lane: str, share: float) -> None:
            bar.update((lanes.index(lane) + share) / len(lanes), 1.0)

        return prove(source.scene, lanes, how, repeat, told)


def _proof_record(proof: list[dict[str, Any]]) -> dict[str, Any]:
    done = [lane for lane in proof if lane["status"] == "ok"]
    return {
        "identical": bool(done) and all(lane["equal"] for lane in done),
        "saved_seconds": {lane["name"]: lane["saved_seconds"] for lane in done},
        "renderers": proof,
    }


def _status(proof: list[dict[str, Any]]) -> int:
    from crosstrace.harness.outcome import DISAGREES, OK, RENDERER_FAILED

    if any(lane["status"] == "ok" and not lane["equal"] for lane in proof):
        return DISAGREES
    return OK if all(lane["status"] in ("ok", "unsupported") for lane in proof) else RENDERER_FAILED


def _print_proof(proof: list[dict[str, Any]]) -> None:
    if not proof:
        return
    rows = []
    for lane in proof:
        if lane["status"] != "ok":
            rows.append((lane["name"], lane["status"], "", "", ""))
            continue
        said = "identical" if lane["identical"] else "equal" if lane["equal"] else "DIFFERENT"
        times = (*lane["seconds"].values(), lane["saved_seconds"])
        rows.append((lane["name"], said, *(f"{1e3 * it:.1f}" for it in times)))
    console.result("")
    numbers = ("gated ms", "ungated ms", "saved ms")
    console.table(("renderer", "images", *numbers), rows, right=numbers)
    done = [lane for lane in proof if lane["status"] == "ok"]
    for title, key in (
        ("costs (ms)", "cost_seconds"),
        ("left out, saves (ms)", "left_out_seconds"),
    ):
        effects = dict.fromkeys(name for lane in done for name in lane[key])
        if not effects:
            continue
        lines = [(name, *(_milliseconds(lane[key][name]) for lane in done)) for name in effects]
        names = tuple(lane["name"] for lane in done)
        console.result("")
        console.table((title, *names), lines, right=names)
    for lane in proof:
        if lane["status"] != "ok":
            console.result(f"{lane['name']}: {lane['message']}")


def _milliseconds(seconds: float | None) -> str:
    return "not alone" if seconds is None else f"{1e3 * seconds:+.1f}"


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
