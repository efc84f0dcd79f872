"""`crosstrace render`: one image."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from crosstrace.harness.commands import options
from crosstrace.translators.errors import UsageError


@click.command()
@click.argument("scene")
@click.option("--with", "lane", default="native", show_default=True, help="The renderer.")
@click.option(
    "-o", "--output", required=True, type=click.Path(path_type=Path), metavar="FILE",
    help=".npy, .npz (float64), .exr, .pfm (float32), .png or .ppm (8-bit).",
)  # fmt: skip
@click.option("--aov", is_flag=True, help="Side outputs too (.npz): object, t, normal, tree, rays.")
@click.option("--certify", is_flag=True, help="Rigorous enclosures (.npz): lo, hi, undecidable.")
@options.readings
@options.precision
@options.threads
@options.timeout
@options.scene_options
@options.json_output
@options.quiet
def command(
    scene: str, lane: str, output: Path, aov: bool, certify: bool, settings: tuple[str, ...],
    precision: str, threads: int, timeout: float, delivery: int | None, size: str | None,
    as_json: bool, quiet: bool,
) -> None:  # fmt: skip
    """Render SCENE with one renderer and write the image."""
    resolution = options.resolution(size)
    from crosstrace.harness import console, images, one_image, record
    from crosstrace.harness.display import DisplayRule
    from crosstrace.harness.sources import find_one
    from crosstrace.translators import readings
    from crosstrace.translators.renderer import RenderOptions

    suffix = images.suffix_of(output)
    if (aov or certify) and suffix != ".npz":
        raise UsageError(f"{output}: --aov and --certify expect a file name ending in .npz")
    if (aov or certify) and lane != "native":
        raise UsageError(f"--aov and --certify expect the renderer native, found {lane}")
    rule, others = DisplayRule.split(readings.split(settings))
    readings.check(others)
    source = find_one(scene, delivery=delivery, size=resolution)
    chosen = RenderOptions(
        threads=threads, readings=others, precision=precision, timeout_s=timeout, layers=aov
    )
    with console.progress(quiet or as_json) as observe:
        made = one_image.render(lane, source.scene, chosen, observe=observe)
        layers: dict[str, Any] = made.layers
        if certify:
            layers = layers | one_image.certify(source.scene, others)
    metadata = {
        "scene": source.name, "scene_sha256": source.scene.sha256, "renderer": lane,
        "settings": record.dumps(made.settings).strip(),
    }  # fmt: skip
    images.write(output, made.image, metadata=metadata, layers=layers or None, rule=rule)
    if as_json:
        seconds = vars(made.seconds)
        click.echo(record.dumps({"file": str(output), "seconds": seconds, **made.settings}), nl=False)
