"""Options that several commands take, and how their texts are read."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

if TYPE_CHECKING:
    from crosstrace.harness.display import DisplayRule
    from crosstrace.harness.sources import Source

_MOST_PIXELS_A_SIDE = 10**6


_DELIVERY = click.Choice(["1", "2", "3"])

as_json = click.option("--json", "as_json", is_flag=True, help="Print JSON instead of a table.")
quiet = click.option("-q", "--quiet", is_flag=True, help="Show no progress and no notes.")
settings = click.option(
    "--set", "settings", multiple=True, metavar="READING=VALUE",
    help="Take another reading of the specification; may be repeated.",
)  # fmt: skip
renderers = click.option(
    "--renderers", metavar="A,B", help="Only these, out of native,mitsuba,mitsuba-f64,povray."
)
reference = click.option(
    "--reference", metavar="DIR", type=click.Path(path_type=Path),
    help="A folder of goldens of your own, beside your scenes if you like.",
)  # fmt: skip
precision = click.option(
    "--precision", default="f64", show_default=True, help="Arithmetic of native."
)
sampling = click.option(
    "--sampling", default="centre", show_default=True, metavar="HOW",
    help="Samples of a pixel: centre, regular:K, jittered:K[:SEED] or adaptive:K, K a side.",
)  # fmt: skip
tuning = click.option(
    "--tune", "tuning", multiple=True, metavar="NAME=VALUE",
    help="A setting of the renderer's own, such as povray's antialias=0.1; may be repeated.",
)  # fmt: skip
max_depth = click.option(
    "--max-depth", type=click.IntRange(0), metavar="N",
    help="Another number of bounces than the scene states.",
)  # fmt: skip
threads = click.option(
    "--threads", type=click.IntRange(0), default=0, help="Threads of the renderer; 0: all cores."
)
timeout = click.option(
    "--timeout", type=click.FloatRange(0, min_open=True), metavar="SECONDS", default=300.0,
    show_default=True, help="Give an image up after this time.",
)  # fmt: skip


def _finite(context: click.Context, parameter: click.Parameter, value: float) -> float:
    if not 0 <= value < math.inf:
        raise click.BadParameter(f"expected a number from 0, found {value}")
    return value


tolerance = click.option(
    "--tolerance", type=float, callback=_finite, default=0.0, metavar="X",
    help="Differences that count as equal, on linear float, beside what a renderer cannot hold.",
)  # fmt: skip
junit = click.option("--junit", metavar="FILE", type=click.Path(path_type=Path),
                     help="Write the outcome as JUnit XML.")  # fmt: skip
jobs = click.option(
    "--jobs", type=click.IntRange(1), help="How much is worked on at once; default: one a core."
)


def scene_options(function: Callable[..., Any]) -> Callable[..., Any]:
    """Add the options that say how a scene file is read."""
    size = click.option(
        "--size", metavar="RxC", callback=_as_size, help="Other rows x columns, same field of view."
    )
    delivery = click.option(
        "--delivery", type=_DELIVERY, callback=_as_number, help="Which format the file has."
    )
    return size(delivery(function))


def one_scene(text: str, delivery: int | None, size: tuple[int, int] | None) -> Source:
    """Read the one scene that a text names."""
    from crosstrace.harness.sources import find_one

    return find_one(text, delivery=delivery, size=size)


def deepened(source: Source, max_depth: int | None) -> Source:
    """Return the scene with another number of bounces; raises UsageError where none are traced."""
    from dataclasses import replace

    from crosstrace.translators.errors import UsageError

    if max_depth is None:
        return source
    if source.scene.delivery < 3:
        raise UsageError(f"--max-depth: expected a scene of delivery 3, found {source.name}")
    scene = replace(source.scene, max_depth=max_depth, checked=False)
    return replace(source, scene=scene, expected=None)


def suite(
    texts: Iterable[str],
    reference: Path | None,
    delivery: int | None,
    size: tuple[int, int] | None,
) -> list[Source]:
    """Read the scenes of a regression suite: named, or all of its folder, or all packaged ones."""
    from crosstrace.harness.sources import all_packaged_names, find

    named = list(texts) or ([str(reference)] if reference else all_packaged_names())
    return find(named, delivery=delivery, size=size)


def one_lane(text: str) -> str:
    """Return the name of the one lane that a text names, or raise UsageError."""
    from crosstrace.harness.lanes import chosen
    from crosstrace.translators.errors import UsageError

    lanes = chosen(text)
    if len(lanes) > 1:
        raise UsageError(f"expected one renderer, found {text!r}")
    return lanes[0]


def split_settings(texts: Iterable[str]) -> tuple[DisplayRule, dict[str, str]]:
    """Read `--set` texts: the rule of the 8-bit image, and the readings of the specification."""
    from crosstrace.harness.display import DisplayRule
    from crosstrace.translators import readings

    rule, others = DisplayRule.split(readings.split(texts))
    readings.check(others)
    return rule, others


def check_target(path: Path) -> None:
    """Raise UsageError, before any work is done, where a file cannot be written."""
    from crosstrace.translators.errors import UsageError

    if path.is_dir():
        raise UsageError(f"{path}: expected a file name, found a directory")
    if not path.parent.is_dir():
        raise UsageError(f"{path}: cannot be written: there is no directory {path.parent}")


def check_directory(path: Path) -> None:
    """Raise UsageError, before any work is done, where a directory cannot be."""
    from crosstrace.translators.errors import UsageError

    if path.exists() and not path.is_dir():
        raise UsageError(f"{path}: expected a directory, found a file")


def _as_size(_: click.Context, __: click.Parameter, value: str | None) -> tuple[int, int] | None:
    if value is None:
        return None
    match = re.fullmatch(r"([0-9]{1,7})[x×]([0-9]{1,7})", value, re.ASCII)
    rows, columns = (int(match[1]), int(match[2])) if match else (0, 0)
    if not (1 <= rows <= _MOST_PIXELS_A_SIDE and 1 <= columns <= _MOST_PIXELS_A_SIDE):
        raise click.BadParameter(f"expected rows x columns like 480x640, found {value!r}")
    return rows, columns


def _as_number(_: click.Context, __: click.Parameter, value: str | None) -> int | None:
    return None if value is None else int(value)
