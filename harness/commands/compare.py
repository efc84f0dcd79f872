"""`crosstrace compare`: numbers about two images."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path

import click

from crosstrace.harness.commands import options
from crosstrace.translators.errors import UsageError


@click.command()
@click.argument("a", type=click.Path(path_type=Path))
@click.argument("b", type=click.Path(path_type=Path))
@click.option("--scene", help="The scene that both show: checks their size.")
@options.delivery
@options.json_output
def command(a: Path, b: Path, scene: str | None, delivery: int | None, as_json: bool) -> None:
    """Compare the images A and B on linear float, and by SSIM on the display colour."""
    from crosstrace.harness import console, images, record
    from crosstrace.harness.metrics import measure
    from crosstrace.harness.sources import find_one
    from crosstrace.harness.ssim import similarity

    first, second = images.read(a), images.read(b)
    numbers = measure(first, second)
    if scene is not None:
        shape = find_one(scene, delivery=delivery).scene.shape
        if first.shape != shape:
            wanted, found = (f"{s[0]}x{s[1]}" for s in (shape, first.shape))
            raise UsageError(f"{a}: expected {wanted} pixels as the scene says, found {found}")
    found = {
        "a": str(a), "b": str(b), "max": numbers.max, "mean": numbers.mean, "bias": numbers.bias,
        "rmse": numbers.rmse, "psnr": numbers.psnr, "ssim": similarity(first, second).mean,
        **numbers.over, "pixels": numbers.pixels, "differing": numbers.differing,
        "nonfinite": numbers.nonfinite, "worst": [asdict(pixel) for pixel in numbers.worst],
    }  # fmt: skip
    if as_json:
        click.echo(record.dumps(found), nl=False)
    else:
        console.comparison(found)
