"""`crosstrace compare`: two image files in numbers."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from crosstrace.harness import console
from crosstrace.harness.commands import options

if TYPE_CHECKING:
    from crosstrace.harness.comparison import Comparison
    from crosstrace.harness.row_files import RowsOfFile
    from crosstrace.translators.scene import Scene

_LABELS = {
    "max": "greatest difference",
    "mean": "mean difference",
    "bias": "mean of A - B",
    "rmse": "root mean square",
    "psnr": "PSNR (peak 1), dB",
    "ssim": "SSIM of the display colour",
    "over_1_255": "pixels beyond 1/255",
    "over_1e_4": "pixels beyond 1e-4",
    "over_1e_9": "pixels beyond 1e-9",
    "differing": "pixels that differ at all",
    "nonfinite": "pixels not finite",
    "pixels": "pixels",
}


@click.command("compare")
@click.argument("a")
@click.argument("b")
@click.option("--scene", help="The scene of both images: their size and origin are checked.")
@options.scene_options
@options.as_json
def command(
    a: str,
    b: str,
    scene: str | None,
    size: tuple[int, int] | None,
    delivery: int | None,
    as_json: bool,
) -> None:
    """Compare the images A and B on linear float.

    8-bit values v are taken as v / 255. The formats are those of `render`.
    """
    from crosstrace.harness.comparison import compare_rows
    from crosstrace.harness.row_files import reading

    known = None if scene is None else options.one_scene(scene, delivery, size).scene
    with reading(a) as first, reading(b) as second:
        for path, image in ((a, first), (b, second)):
            _check_origin(path, image, known)
        compared = compare_rows(first, second, known)
    if as_json:
        about = None if known is None else {"name": known.name, "sha256": known.sha256}
        console.json_result({"a": a, "b": b, "scene": about, **compared.record()})
        return
    _print(compared)


def _check_origin(path: str, image: RowsOfFile, scene: Scene | None) -> None:
    from crosstrace.harness.images import PREFIX
    from crosstrace.translators.errors import UsageError

    made_of = image.metadata.get(PREFIX + "scene_sha256")
    if scene is not None and made_of not in (None, scene.sha256):
        raise UsageError(f"{path}: expected an image of {scene.name}, found one of another scene")


def _print(compared: Comparison) -> None:
    record = compared.record()
    rows = []
    for key, label in _LABELS.items():
        value = record[key]
        counted = isinstance(value, int)
        text = f"{value:,}" if counted else console.number(value, 6 if key == "ssim" else 4)
        if key == "psnr" and compared.metrics.rmse == 0.0:
            text = "infinite"
        rows.append((label, text))
    console.table(("", "value"), rows, right=("value",))
    if compared.metrics.worst:
        console.result("\nworst pixels")
        header = ("row", "column", "difference", "A", "B")
        worst = [
            (str(p.row), str(p.col), console.number(p.difference), _color(p.a), _color(p.b))
            for p in compared.metrics.worst
        ]
        console.table(header, worst, right=header[:3])


def _color(color: tuple[float, float, float]) -> str:
    return " ".join(f"{value:.5g}" for value in color)
