"""`crosstrace compare`: the numbers of two image files."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from crosstrace.harness.commands import options

if TYPE_CHECKING:
    from collections.abc import Mapping


@click.command(name="compare")
@click.argument("a", type=click.Path(path_type=Path), metavar="A")
@click.argument("b", type=click.Path(path_type=Path), metavar="B")
@click.option("--scene", metavar="SCENE", help="The scene that both show.")
@options.as_json
def command(a: Path, b: Path, scene: str | None, as_json: bool) -> None:
    """Compare the images A and B, of one size, on linear float.

    8-bit values v count as v / 255. The numbers inform; no verdict is drawn from them.
    """
    from crosstrace.harness import api, console
    from crosstrace.harness.sources import find_one

    known = None if scene is None else find_one(scene).scene
    found = api.compare(a, b, scene=known)
    numbers = asdict(found.metrics)
    record = {
        "a": str(a),
        "b": str(b),
        "scene_sha256": None if known is None else known.sha256,
        "ssim": found.ssim,
        **numbers.pop("over"),
        **numbers,
    }
    if as_json:
        console.print_json(record)
    else:
        click.echo(_text(record))


def _text(record: Mapping[str, Any]) -> str:
    from crosstrace.harness.console import table
    from crosstrace.harness.page.draw import significant, similarity

    identical = record["differing"] == 0
    rows = [
        ["max |a − b|", significant(record["max"], 6)],
        ["mean |a − b|", significant(record["mean"], 6)],
        ["mean a − b", significant(record["bias"], 6)],
        ["RMSE", significant(record["rmse"], 6)],
        ["PSNR", "identical" if identical else f"{significant(record['psnr'], 4)} dB"],
        ["SSIM", similarity(record["ssim"])],
        ["pixels beyond 1/255", str(record["over_1_255"])],
        ["pixels beyond 1e-4", str(record["over_1e_4"])],
        ["pixels beyond 1e-9", str(record["over_1e_9"])],
        ["pixels differing", str(record["differing"])],
        ["pixels not finite", str(record["nonfinite"])],
        ["pixels", str(record["pixels"])],
    ]
    text = table(rows[0], rows[1:])
    worst = [
        [f"{p['row']}, {p['col']}", significant(p["difference"], 6),
         " ".join(significant(v, 6) for v in p["a"]), " ".join(significant(v, 6) for v in p["b"])]
        for p in record["worst"]
    ]  # fmt: skip
    head = ["worst at row, column", "|a − b|", "a", "b"]
    return f"{text}\n\n{table(head, worst)}" if worst else text
