"""`crosstrace render`: one image by one renderer."""

from __future__ import annotations

from pathlib import Path

import click

from crosstrace.harness.commands import options


@click.command(name="render")
@options.scene
@click.option("--with", "lane", default="native", show_default=True, metavar="LANE",
              help="Which renderer: native, mitsuba, mitsuba-f64, povray.")  # fmt: skip
@click.option("-o", "--output", required=True, type=click.Path(path_type=Path), metavar="FILE",
              help=".npy, .npz: float64; .exr, .pfm: float32; .png, .ppm: 8-bit.")  # fmt: skip
@options.settings
@click.option("--precision", default="f64", show_default=True, metavar="NAME",
              help="Arithmetic of the native renderer.")  # fmt: skip
@options.threads
@click.option("--aov", "layers", is_flag=True, help="Add side outputs to an .npz.")
@options.timeout(None)
@options.size
@options.delivery
@options.as_json
@options.quiet
def command(
    scene: str,
    lane: str,
    output: Path,
    settings: tuple[str, ...],
    precision: str,
    threads: int,
    layers: bool,
    timeout_s: float | None,
    size: tuple[int, int] | None,
    delivery: int | None,
    as_json: bool,
    quiet: bool,
) -> None:
    """Render SCENE to an image file; --set also takes overflow and quantise, the 8-bit rule."""
    from crosstrace.harness import api, console, images, lanes, one_image
    from crosstrace.harness.sources import find_one
    from crosstrace.translators.errors import UsageError
    from crosstrace.translators.renderer import RenderOptions

    # Everything that can be refused is refused before any work is done.
    suffix = images.suffix_of(output)
    if layers and suffix != ".npz":
        raise UsageError(f"{output}: expected a file name ending in .npz for the side outputs")
    if not output.absolute().parent.is_dir():
        raise UsageError(f"{output}: expected an existing directory, found none")
    (lane,) = lanes.chosen([lane])
    rule, readings = one_image.readings(settings)
    source = find_one(scene, delivery=delivery, size=size)
    render_options = RenderOptions(
        threads=threads, readings=readings, precision=precision, timeout_s=timeout_s, layers=layers
    )
    with console.fraction(quiet, f"{source.name} by {lane}") as progress:
        made, peak_mib = api.rendered(source.scene, lane, render_options, progress)
    if layers and not made.layers:
        raise UsageError(f"--aov: {lane} has no side outputs")
    entry = one_image.save(output, source, lane, made, rule)
    if as_json:
        console.print_json({**entry, "peak_mib": peak_mib})
        return
    for message in made.messages:
        click.echo(f"{lane}: {message}", err=True)
    if not quiet:
        click.echo(f"{output}: {source.name} by {lane} in {made.seconds.render:.3f} s")
