"""What a terminal shows: progress, and tables that fit 80 columns.

A bar on a terminal, plain lines elsewhere; all of it on standard error, so that standard output
holds results alone. Colours are left out under NO_COLOR.
"""

from __future__ import annotations

import contextlib
import sys
import time
from collections.abc import Callable, Iterator, Mapping
from typing import Any

import click

from crosstrace.harness.schedule import Event

#: Elsewhere than on a terminal, a line no more often than this, but for failures and the last.
_LINE_EVERY_S = 5.0


@contextlib.contextmanager
def progress(quiet: bool) -> Iterator[Callable[[Event], None]]:
    """Give a function to be told of events, drawn as a bar or as lines; quiet: not at all."""
    if quiet:
        yield lambda event: None
    elif sys.stderr.isatty():
        with _bar() as observe:
            yield observe
    else:
        yield _lines()


@contextlib.contextmanager
def _bar() -> Iterator[Callable[[Event], None]]:
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn
    from rich.progress import TimeElapsedColumn, TimeRemainingColumn

    columns = (
        BarColumn(bar_width=24), MofNCompleteColumn(), TimeElapsedColumn(), TimeRemainingColumn(),
        TextColumn("{task.description}", markup=False),
    )  # fmt: skip
    with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task("starting", total=None)

        def observe(event: Event) -> None:
            if event.kind == "failed":
                bar.console.print(_sentence(event), markup=False, highlight=False)
            done = event.done + event.fraction
            bar.update(task, total=event.total, completed=done, description=_sentence(event))

        yield observe


def _lines() -> Callable[[Event], None]:
    last = time.monotonic()

    def observe(event: Event) -> None:
        nonlocal last
        now = time.monotonic()
        done = event.kind in ("done", "failed")
        ends = event.kind == "failed" or (done and event.done == event.total)
        if ends or (done and now - last >= _LINE_EVERY_S):
            last = now
            click.echo(f"[{event.done}/{event.total}] {_sentence(event)}", err=True)

    return observe


def _sentence(event: Event) -> str:
    text = f"{event.what} {event.scene}: {event.lane}"
    return f"{text} failed: {event.message}" if event.kind == "failed" else text


def summary(report: Mapping[str, Any]) -> None:
    """Print what a run found: each lane of each scene against the first lane."""
    lanes = [lane["name"] for lane in report["scenes"][0]["renderers"]]
    base, others = lanes[0], lanes[1:]
    width = max(len("scene"), *(len(scene["name"]) for scene in report["scenes"]))
    width = min(width, 20)
    title = f"Greatest difference to {base} on linear float (pixels beyond 1/255)"
    click.echo(click.style(title, bold=True) if _has_colors() else title)
    click.echo(f"{'scene':{width}}" + "".join(f"{lane:>19}" for lane in others))
    for scene in report["scenes"]:
        status = {lane["name"]: lane["status"] for lane in scene["renderers"]}
        pairs = {pair["b"]: pair for pair in scene["pairs"] if pair["a"] == base}
        cells = [_cell(status, base, lane, pairs.get(lane)) for lane in others]
        click.echo(f"{scene['name'][:width]:{width}}" + "".join(f"{cell:>19}" for cell in cells))
    seen = set()
    for scene in report["scenes"]:
        for lane in scene["renderers"]:
            if lane["status"] != "ok" and (lane["name"], lane["message"]) not in seen:
                seen.add((lane["name"], lane["message"]))
                click.echo(f"{lane['name']} {lane['status']}: {lane['message']}")


def _cell(status: Mapping[str, str], base: str, lane: str, pair: Mapping[str, Any] | None) -> str:
    for name in (lane, base):
        if status[name] != "ok":
            return status[name] if name == lane else f"no {base}"
    if pair is None or pair["pixels"] is None:
        return "not compared"
    size = "not finite" if pair["max"] is None else f"{pair['max']:.1e}" if pair["max"] else "0"
    return f"{size} ({pair['over_1_255']})"


def comparison(found: Mapping[str, Any]) -> None:
    """Print the numbers of one comparison."""
    for key in ("max", "mean", "bias", "rmse", "psnr", "ssim"):
        value = found[key]
        click.echo(f"{key:12}{'-' if value is None else format(value, '.6g')}")
    pixels = found["pixels"]
    for key, label in (("over_1_255", "> 1/255"), ("over_1e_4", "> 1e-4"), ("over_1e_9", "> 1e-9")):
        click.echo(f"{label:12}{found[key]} of {pixels} pixels")
    if found["nonfinite"]:
        click.echo(f"not finite  {found['nonfinite']} of {pixels} pixels")
    for pixel in found["worst"]:
        a, b = (" ".join(f"{v:.6g}" for v in pixel[side]) for side in "ab")
        click.echo(f"  row {pixel['row']} column {pixel['col']}: {a} against {b}")


def effects(found: Mapping[str, Any], is_sphere: list[bool]) -> None:
    """Print what a scene calls for."""
    click.echo(f"{found['scene']} calls for: {', '.join(found['effects']) or 'nothing'}")
    click.echo(f"left out: {', '.join(found['left_out']) or 'nothing'}")
    for item, ball in zip(found["objects"], is_sphere, strict=True):
        kind = "sphere" if ball else "plane"
        click.echo(f"  {item['index']:4} {kind:7}{', '.join(item['effects']) or 'nothing'}")


def doctor(answer: Mapping[str, Any]) -> None:
    """Print which lanes work."""
    about = answer["environment"]
    click.echo(f"crosstrace {about['crosstrace']}, Python {about['python']}, {about['system']}")
    click.echo(f"{about['cpu']}, {about['cores']} cores")
    for lane in answer["renderers"]:
        state = lane["version"] if lane["available"] else "missing"
        click.echo(f"{lane['name']:13}{state}")
        for name, value in lane["details"].items():
            click.echo(f"{'':13}{name}: {value}")
        if not lane["available"]:
            click.echo(f"{'':13}{lane['reason']}")
            if lane["remedy"]:
                click.echo(f"{'':13}install it with: {lane['remedy']}")


def _has_colors() -> bool:
    import os

    return sys.stdout.isatty() and not os.environ.get("NO_COLOR")
