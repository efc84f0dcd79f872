"""`crosstrace bench`: the native tracer against its peers, on the same rays and images."""

from __future__ import annotations

from textwrap import wrap
from typing import Any

import click

from crosstrace.harness import console
from crosstrace.harness.commands import options

_MOST_SPHERES = 10**7


def _as_numbers(
    context: click.Context, parameter: click.Parameter, text: str | None
) -> tuple[int, ...] | None:
    if text is None:
        return None
    try:
        numbers = [int(it) for it in text.split(",")]
    except ValueError:
        numbers = [-1]
    if not all(0 <= n <= _MOST_SPHERES for n in numbers):
        raise click.BadParameter(f"expected numbers from 0 to {_MOST_SPHERES}, found {text!r}")
    return tuple(n for n in numbers if n > 0)


@click.command("bench")
@click.option("--scenes", metavar="A,B", help="Scenes to measure with: names or files; '': none; "
              "default: glass-bench,phong-bench,vidro4.")  # fmt: skip
@click.option("--spheres", metavar="N,N", callback=_as_numbers, help="Numbers of spheres to read, "
              "sort and intersect; 0: none; default: 1000,100000,1000000.")  # fmt: skip
@click.option("--repeat", type=click.IntRange(1), default=5, show_default=True,
              help="Runs, of which numbers are medians.")  # fmt: skip
@options.scene_options
@options.timeout
@options.as_json
@options.quiet
def command(
    scenes: str | None,
    spheres: tuple[int, ...] | None,
    repeat: int,
    size: tuple[int, int] | None,
    delivery: int | None,
    timeout: float,
    as_json: bool,
    quiet: bool,
) -> int:
    """Measure the native tracer against Mitsuba, POV-Ray and Embree, on the same rays and images.

    Everything is measured in turn in one run, scenes at 1080x1920 unless --size says otherwise. A
    ratio above 1 means that the native tracer is faster, or the first of its two ways that a row
    names; beside a peak it is the part that is reached.
    The exit status is 3 where something that was to be measured is missing or failed.
    """
    from crosstrace.harness.bench.measure import SCENES, SIZE, SPHERES, bench
    from crosstrace.harness.outcome import OK, RENDERER_FAILED
    from crosstrace.harness.sources import find
    from crosstrace.translators.errors import UsageError

    names = SCENES if scenes is None else [it for it in scenes.split(",") if it]
    sources = find(names, delivery=delivery, size=size or SIZE) if names else []
    crowds = SPHERES if spheres is None else spheres
    if not sources and not crowds:
        raise UsageError("expected scenes or numbers of spheres, found neither")
    with console.progress(quiet, "measuring", counted=False) as bar:
        record = bench(sources, crowds, repeat, timeout,
                       lambda share, name: bar.update(share, 1.0, name))  # fmt: skip
    if as_json:
        console.json_result(record)
    else:
        _print(record)
    return OK if all(row["status"] == "ok" for row in record["rows"]) else RENDERER_FAILED


def _print(record: dict[str, Any]) -> None:
    machine = record["machine"]
    console.result(f"{machine['cpu']}, cores: {machine['cores']}; {machine['compiler']}")
    sizes = {f"{rows}x{columns}" for rows, columns in record["settings"]["size"]}
    medians = f"medians of {record['settings']['repeat']} runs"
    console.result(", ".join([*sorted(sizes), medians]))
    console.result("")
    numbers = ("ours", "theirs", "ratio")
    table = [
        (row["name"], *(_number(row[key]) for key in numbers[:2]), _ratio(row), row["unit"])
        for row in record["rows"]
    ]
    console.table(("", *numbers, "unit"), table, right=numbers)
    wrong = dict.fromkeys(row["message"] for row in record["rows"] if row["status"] != "ok")
    for message in wrong:
        console.result("\n".join(wrap(message, console.WIDTH)))


def _number(value: float | None) -> str:
    if value is None:
        return ""
    return f"{value:.4f}" if value < 1 else f"{value:.3f}" if value < 10 else f"{value:.1f}"


def _ratio(row: dict[str, Any]) -> str:
    if row["status"] != "ok":
        return str(row["status"])
    return "" if row["ratio"] is None else f"{row['ratio']:.2f}"
