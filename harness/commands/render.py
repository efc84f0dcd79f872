"""`crosstrace render`: one image of one scene by one renderer."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from crosstrace.harness import console
from crosstrace.harness.commands import options

if TYPE_CHECKING:
    from crosstrace.harness.display import DisplayRule
    from crosstrace.translators.renderer import Rendering
    from crosstrace.translators.scene import Scene


@click.command("render")
@click.argument("scene")
@click.option("--with", "lane", default="native", show_default=True, metavar="RENDERER",
              help="native, mitsuba, mitsuba-f64 or povray.")  # fmt: skip
@click.option("-o", "--output", type=click.Path(path_type=Path), required=True,
              help=".npy, .npz (float64), .exr, .pfm (float32), .png or .ppm (8-bit).")  # fmt: skip
@options.settings
@options.precision
@click.option("--tolerance", type=click.FloatRange(0, 1e100), default=0.0, metavar="T",
              help="Native: leave out rays that darken no channel by more than T.")  # fmt: skip
@options.max_depth
@options.sampling
@options.tuning
@click.option("--aov", is_flag=True, help="Add native's side outputs to an .npz: object, t, "
              "normal, tree, rays, contributions.")  # fmt: skip
@click.option("--certify", is_flag=True,
              help="Add rigorous enclosures to an .npz: lo, hi, undecidable.")  # fmt: skip
@options.scene_options
@options.threads
@options.timeout
@options.as_json
@options.quiet
def command(
    scene: str,
    lane: str,
    output: Path,
    settings: tuple[str, ...],
    precision: str,
    tolerance: float,
    max_depth: int | None,
    sampling: str,
    tuning: tuple[str, ...],
    aov: bool,
    certify: bool,
    size: tuple[int, int] | None,
    delivery: int | None,
    threads: int,
    timeout: float,
    as_json: bool,
    quiet: bool,
) -> None:
    """Render SCENE to an image file.

    The readings of --set other than `overflow` and `quantise`, which shape the 8-bit image, are
    native's.
    """
    from crosstrace.harness import alone, images
    from crosstrace.harness.bands import is_large
    from crosstrace.harness.lanes import REFERENCE
    from crosstrace.translators import sampling as samplings
    from crosstrace.translators.readings import split
    from crosstrace.translators.renderer import RenderOptions

    lane = options.one_lane(lane)
    rule, readings = options.split_settings(settings)
    _check(lane, output, rule, {"--aov": aov, "--certify": certify,
                                f"--precision {precision}": precision != "f64",
                                f"--tolerance {tolerance:g}": tolerance > 0})  # fmt: skip
    source = options.deepened(options.one_scene(scene, delivery, size), max_depth)
    how = RenderOptions(threads, readings, precision, timeout_s=timeout, layers=aov,
                        tolerance=tolerance, sampling=samplings.parse(sampling),
                        tuning=split(tuning))  # fmt: skip
    large = is_large(*source.scene.shape[:2]) and how.sampling == samplings.CENTRE
    in_bands = lane == REFERENCE and not aov and not certify and large
    with console.progress(quiet, f"{source.name} by {lane}", counted=False) as bar:

        def told(share: float) -> None:
            bar.update(share, 1.0)

        if in_bands:
            # How many rays there were is not known when the file begins.
            settings_known = {"precision": precision, "readings": readings}
            metadata = _texts(_about(lane, source.scene, settings_known))
            made, peak_mib = alone.render_to_file(
                source.scene, how, output, metadata, rule, progress=told
            )
        else:
            made, peak_mib = alone.render(lane, source.scene, how, progress=told)
            layers = made.layers if aov else {}
            if certify:
                layers |= alone.certify(source.scene, readings, timeout)
    described = _describe(lane, source.scene, made)
    if not in_bands:
        images.write(output, made.image, metadata=_texts(described), layers=layers or None,
                     rule=rule)  # fmt: skip
    if as_json:
        console.json_result({**described, "file": str(output), "peak_mib": peak_mib})
        return
    seconds = made.seconds
    total = seconds.startup + seconds.translate + seconds.render
    rows, columns, _ = source.scene.shape
    console.note(f"{output}: {rows}x{columns}, {lane}, {total:.2f} s, {peak_mib:.0f} MiB", quiet)


def _check(lane: str, output: Path, rule: DisplayRule, asked: dict[str, bool]) -> None:
    """Refuse before rendering what the options cannot have together."""
    from crosstrace.harness.display import DisplayRule
    from crosstrace.harness.images import suffix_of
    from crosstrace.harness.lanes import REFERENCE
    from crosstrace.translators.errors import UsageError

    suffix = suffix_of(output)
    options.check_target(output)
    if rule != DisplayRule() and suffix not in (".png", ".ppm"):
        raise UsageError(f"overflow and quantise shape 8-bit images only, found {output}")
    for option in (name for name, wanted in asked.items() if wanted):
        if lane != REFERENCE:
            raise UsageError(f"{option}: expected the renderer {REFERENCE}, found {lane}")
        if option in ("--aov", "--certify") and suffix != ".npz":
            raise UsageError(f"{option}: expected a file name ending in .npz, found {output}")


def _describe(lane: str, scene: Scene, made: Rendering) -> dict[str, Any]:
    from dataclasses import asdict

    return {
        **_about(lane, scene, made.settings),
        "half_step": made.half_step,
        "seconds": asdict(made.seconds),
        "messages": made.messages,
    }


def _about(lane: str, scene: Scene, settings: dict[str, Any]) -> dict[str, Any]:
    import crosstrace

    return {
        "scene": scene.name,
        "scene_sha256": scene.sha256,
        "renderer": lane,
        "crosstrace": crosstrace.__version__,
        "settings": settings,
    }


def _texts(described: dict[str, Any]) -> dict[str, str]:
    """Return the metadata of an image file: what makes the image, not how long it took."""
    kept = {k: v for k, v in described.items() if k not in ("seconds", "messages", "half_step")}
    return {k: v if isinstance(v, str) else json.dumps(v) for k, v in kept.items()}
