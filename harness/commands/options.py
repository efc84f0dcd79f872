"""Options and arguments that several subcommands share."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Any

import click

Decorator = Callable[[Callable[..., Any]], Callable[..., Any]]


class Size(click.ParamType):
    """Rows and columns of an image, written as 480x640."""

    name = "RxC"

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> tuple[int, int]:
        """Return (rows, columns)."""
        match = re.fullmatch(r"(\d{1,6})[xX×](\d{1,6})", str(value))
        if not match or "0" in (match[1].lstrip("0") or "0", match[2].lstrip("0") or "0"):
            self.fail(f"expected ROWSxCOLUMNS, as in 480x640, found {value!r}", param, ctx)
        return int(match[1]), int(match[2])


scene = click.argument("scene", metavar="SCENE")

delivery = click.option(
    "--delivery", type=click.IntRange(1, 3), help="Read the scene as this delivery's format."
)
size = click.option(
    "--size", type=Size(), help="Another resolution with the same field of view, as in 480x640."
)
as_json = click.option("--json", "as_json", is_flag=True, help="Print JSON to standard output.")
quiet = click.option("-q", "--quiet", is_flag=True, help="Print errors and results only.")
settings = click.option(
    "--set", "settings", multiple=True, metavar="READING=VALUE",
    help="Another reading of the specification; may be repeated.",
)  # fmt: skip
threads = click.option(
    "--threads", type=click.IntRange(0), default=0, help="Threads of the renderer; 0: every core."
)


def timeout(default: float | None) -> Decorator:
    """Make the option that bounds the seconds of one image."""
    return click.option(
        "--timeout", "timeout_s", type=click.FloatRange(0, min_open=True), default=default,
        show_default=default is not None, metavar="SECONDS", help="Give an image up after this.",
    )  # fmt: skip
