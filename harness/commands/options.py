"""Options that several commands share, and what their texts mean."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Any

import click

from crosstrace.translators.errors import UsageError

json_output = click.option("--json", "as_json", is_flag=True, help="Print JSON.")
quiet = click.option("-q", "--quiet", is_flag=True, help="No progress, no summary.")
delivery = click.option(
    "--delivery", type=click.IntRange(1, 3), help="Read as this delivery, whatever the text says."
)
size = click.option(
    "--size", metavar="RxC", help="Another resolution, rows x columns; the field of view stays."
)
renderers = click.option(
    "--renderers", metavar="A,B", help="Only these renderers; see `crosstrace doctor`."
)
timeout = click.option(
    "--timeout", type=click.FloatRange(min=0, min_open=True), metavar="S", default=300.0,
    show_default=True, help="Seconds after which a renderer is taken to hang.",
)  # fmt: skip
threads = click.option(
    "--threads", type=click.IntRange(min=0), default=0, metavar="N", help="0: all cores."
)
readings = click.option(
    "--set", "settings", multiple=True, metavar="NAME=VALUE",
    help="Another reading of the specification, such as tir=ignore; may be repeated.",
)  # fmt: skip
precision = click.option(
    "--precision", default="f64", show_default=True, help="Arithmetic of the native tracer."
)


def resolution(text: str | None) -> tuple[int, int] | None:
    """Read `480x640` as (rows, columns); raises UsageError for anything else."""
    if text is None:
        return None
    found = re.fullmatch(r"([1-9]\d{0,6})[xX×]([1-9]\d{0,6})", text)
    if not found:
        raise UsageError(f"--size: expected ROWSxCOLUMNS such as 480x640, found {text!r}")
    return int(found[1]), int(found[2])


def scene_options(function: Callable[..., Any]) -> Callable[..., Any]:
    """Add the options that say how a scene is read."""
    return delivery(size(function))
