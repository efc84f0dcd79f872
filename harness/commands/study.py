"""`crosstrace study`: what accuracy costs in time."""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING

import click

from crosstrace.harness import console
from crosstrace.harness.commands import options

if TYPE_CHECKING:
    from crosstrace.harness.study.experiment import Entry

_KINDS = ("rounding", "certified", "model", "offset", "pruning", "depth", "sampling")


def _as_seconds(_: click.Context, __: click.Parameter, value: str | None) -> float | None:
    if value is None:
        return None
    match = re.fullmatch(r"([0-9.]+(?:e-?[0-9]+)?) ?(s|ms)?", value, re.ASCII)
    try:
        seconds = float(match[1]) * (1e-3 if match[2] == "ms" else 1.0) if match else 0.0
    except ValueError:
        seconds = 0.0
    if seconds <= 0:
        raise click.BadParameter(f"expected a time like 0.1s or 20ms, found {value!r}")
    return seconds


@click.command("study")
@click.argument("scenes", nargs=-1, required=True, metavar="SCENE...")
@click.option("-o", "--output", metavar="DIR", type=click.Path(path_type=Path),
              help="Write study.json, study.svg and a report there.")  # fmt: skip
@click.option("--want", type=click.FloatRange(0, min_open=True), metavar="ERROR",
              help="Advise the cheapest setting with this error at most.")  # fmt: skip
@click.option("--budget", callback=_as_seconds, metavar="TIME",
              help="Advise the most exact setting within a time such as 0.1s.")  # fmt: skip
@click.option("--metric", type=click.Choice(["max", "rmse", "p999"]), default="rmse",
              show_default=True, help="The error that is meant.")  # fmt: skip
@click.option("--clock", type=click.Choice(["wall", "processor"]), default="wall",
              show_default=True, help="The time that is meant; processor: of all threads, which "
              "other work disturbs less.")  # fmt: skip
@click.option("--kind", type=click.Choice(_KINDS),
              help="Advise on this kind of error; default: on all from the truth.")  # fmt: skip
@click.option("--samples", type=click.IntRange(1, 32), default=32, show_default=True,
              help="Samples of a pixel, a side, at most.")  # fmt: skip
@click.option("--runs", type=click.IntRange(3, 100), default=7, show_default=True,
              help="Timed runs of each setting; more of quick ones, 3 of slow ones.")  # fmt: skip
@options.renderers
@options.scene_options
@click.option("--threads", type=click.IntRange(0), default=1, show_default=True,
              help="Threads of a renderer; 0: all cores.")  # fmt: skip
@options.timeout
@options.as_json
@options.quiet
def command(
    scenes: tuple[str, ...],
    output: Path | None,
    want: float | None,
    budget: float | None,
    metric: str,
    clock: str,
    kind: str | None,
    samples: int,
    runs: int,
    renderers: str | None,
    size: tuple[int, int] | None,
    delivery: int | None,
    threads: int,
    timeout: float,
    as_json: bool,
    quiet: bool,
) -> int:
    """Say what accuracy costs in time for every SCENE, and advise.

    Precisions, renderers and their settings, epsilon, bounces and samples on one scale: time
    against error. Errors of different kinds are kept apart, as rounding is measured against the
    certified value, samples against the converged average, bounces against a deep render. Scenes of
    more than 120 rows are studied at 120 unless --size says otherwise.
    """
    from crosstrace.harness.lanes import chosen
    from crosstrace.harness.sources import find
    from crosstrace.harness.study import experiment, record
    from crosstrace.harness.study.advice import DEFAULT_WANT, Wish
    from crosstrace.translators.errors import UsageError

    if want is not None and budget is not None:
        raise UsageError("expected --want or --budget, found both")
    wish = Wish(want or DEFAULT_WANT, budget, metric, kind)
    how = experiment.Options(chosen(renderers), size, threads, runs, samples, timeout, metric,
                             clock)  # fmt: skip
    todo = experiment.entries(find(scenes, delivery=delivery), size)
    if output is not None:
        options.check_directory(output)
    with console.progress(quiet, f"scenes: {len(todo)}") as bar:
        for event in experiment.study(todo, how):
            bar.update(*event.progress, stage=event.stage)
    made = record.record(todo, how, wish)
    if output is not None:
        from crosstrace.harness.study.files import publish

        publish(made, todo, how, output)
    if as_json:
        console.json_result(made)
    else:
        _print(todo, made["advice"], output, quiet)
    return experiment.exit_status(todo)


def _print(todo: list[Entry], advice: str, output: Path | None, quiet: bool) -> None:
    from crosstrace.harness.study.table import HEADER, LEGEND, NUMBERS, tables

    for entry in todo:
        if not quiet:
            rows, columns, _ = entry.scene.shape
            console.result(f"{entry.source.name}, {rows}x{columns}\n{LEGEND}")
            for table in tables(entry):
                console.result(f"\n{table.title}")
                console.table(HEADER, table.rows, right=NUMBERS)
            console.result("")
        for what, why in entry.failures.items():
            console.result(f"{entry.source.name}: {what}: {why}")
    console.result(advice)
    if output is not None and not quiet:
        console.result(f"\npicture: {output / 'study.svg'}")
