"""`crosstrace stability`: how far the result can be trusted numerically."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from crosstrace.harness import console
from crosstrace.harness.commands import options

if TYPE_CHECKING:
    from crosstrace.harness.metamorphic import Outcome
    from crosstrace.harness.stability import Entry

#: So many reasons of undecidable pixels are told a scene; JSON has them all.
_MOST_REASONS = 3


@click.command("stability")
@click.argument("scenes", nargs=-1, metavar="[SCENE]...")
@click.option("-o", "--output", metavar="DIR", type=click.Path(path_type=Path),
              help="Write pictures and stability.json there.")  # fmt: skip
@click.option("--metamorphic", "checks", is_flag=True,
              help="Also check changes that must not change the picture.")  # fmt: skip
@click.option("--renderers", metavar="A,B",
              help="Check these with --metamorphic; default: all.")  # fmt: skip
@options.scene_options
@options.threads
@options.timeout
@options.jobs
@options.as_json
@options.quiet
def command(
    scenes: tuple[str, ...],
    output: Path | None,
    checks: bool,
    renderers: str | None,
    size: tuple[int, int] | None,
    delivery: int | None,
    threads: int,
    timeout: float,
    jobs: int | None,
    as_json: bool,
    quiet: bool,
) -> int:
    """Say how far native's result for every SCENE can be trusted numerically.

    Certifies each pixel and renders in every precision: where the ray tree changes, how large
    errors are, which decisions are open, what rounding and another epsilon change. Without a SCENE
    it takes the packaged hard scenes. Scenes of more than 120 rows are measured at 120 unless
    --size says otherwise. The exit status is 1 where a packaged hard scene exceeds the thresholds
    that its index states, or a metamorphic check fails.
    """
    from crosstrace.harness import stability
    from crosstrace.harness.lanes import chosen
    from crosstrace.harness.sources import find, hard_names
    from crosstrace.translators.errors import UsageError

    if renderers is not None and not checks:
        raise UsageError("--renderers: expected together with --metamorphic")
    lanes = chosen(renderers) if checks else ()
    how = stability.Options(lanes, size, jobs or 0, threads, timeout)
    todo = stability.entries(find(scenes or hard_names(), delivery=delivery), size)
    if output is not None:
        options.check_directory(output)
    with console.progress(quiet, f"scenes: {len(todo)}") as bar:
        for event in stability.study(todo, how):
            bar.update(*event.progress, stage=event.stage)
    if output is not None:
        from crosstrace.harness.stability_files import publish

        publish(todo, output)
    if as_json:
        console.json_result(stability.record(todo))
    else:
        _print(todo, output, quiet)
    return stability.exit_status(todo)


def _print(todo: list[Entry], output: Path | None, quiet: bool) -> None:
    for entry in todo:
        if not quiet:
            _print_scene(entry)
        for what, why in (*entry.failures.items(), *entry.unsupported.items()):
            console.result(f"{entry.source.name}: {what}: {why}")
        for sentence in entry.departures:
            console.result(f"{entry.source.name}: {sentence}")
        for it in entry.broken:
            who = f"{entry.source.name}: {it.relation}, {it.renderer} {it.precision}"
            console.result(f"{who}: {it.over} of {it.compared} pixels differ beyond their bound")
        if not quiet:
            console.result("")
    if output is not None and not quiet:
        console.result(f"pictures: {output}")


def _print_scene(entry: Entry) -> None:
    rows, columns, _ = entry.scene.shape
    own_rows, own_columns, _ = entry.source.scene.shape
    size = f"{rows}x{columns}" + ("" if entry.at_own_size else f" of {own_rows}x{own_columns}")
    if entry.found is None:
        console.result(f"{entry.source.name}, {size}: not measured")
    else:
        known = entry.found.known
        console.result(f"{entry.source.name}, {size}: {100 * known.certified_fraction:.4g} % "
                       f"certified, {known.undecidable.sum()} undecidable")  # fmt: skip
        for reason in entry.found.reasons[:_MOST_REASONS]:
            about = "" if reason.object < 0 else f", object {reason.object}"
            what = f"{reason.decision}{about}, depth {reason.depth}"
            row, column = reason.pixel
            console.result(f"  {reason.count} open: {what}, first at row {row}, column {column}")
        _print_rungs(entry)
        _print_epsilons(entry)
    _print_checks(entry)


def _print_rungs(entry: Entry) -> None:
    assert entry.found is not None
    header = ("rung", "trees", "decidable", "median", "p99", "p99.9", "max", "digits", "seconds")
    table = []
    for rung in entry.found.rungs:
        error = [console.number(rung.error[key]) for key in ("median", "p99", "p999", "max")]
        lost = entry.found.digits.get(rung.precision)
        digits = "-" if lost is None else f"{lost.max() * 0.30103:.1f}"
        table.append((rung.precision, str(rung.changed_trees), str(rung.changed_decidable),
                      *error, digits, console.number(rung.seconds)))  # fmt: skip
    console.table(header, table, right=header[1:])


def _print_epsilons(entry: Entry) -> None:
    assert entry.found is not None
    names = list(entry.found.epsilons)
    exponents = [f"{it.epsilon:.0e}"[-2:] for it in entry.found.epsilons[names[0]]]
    header = ("epsilon 1e-", *exponents)
    rows = [(f"{name} visible", *(str(it.visible) for it in entry.found.epsilons[name]))
            for name in names]  # fmt: skip
    console.table(header, rows, right=header[1:])


def _print_checks(entry: Entry) -> None:
    """Print a table relation × arithmetic of the greatest differences in compared pixels."""
    found = entry.checks
    if not found:
        return
    columns = list(dict.fromkeys((it.renderer, it.precision) for it in found))
    short = {"mitsuba": "mitsuba", "mitsuba-f64": "mit-f64", "povray": "povray"}
    header = ("unchanged by", *(short.get(lane, rung) for lane, rung in columns))
    at = {(it.relation, it.renderer, it.precision): it for it in found}
    relations = list(dict.fromkeys(it.relation for it in found))
    rows = [(name, *(_cell(at[name, *column]) for column in columns)) for name in relations]
    last = [at[relations[-1], *column] for column in columns]
    rows.append(("% compared", *(f"{100 * it.compared / it.pixels:.0f}" for it in last)))
    console.table(header, rows, right=header[1:])
    if any(it.own_rule for it in found):
        console.result("* not unchanged by rights: as a rule of the renderer's own has it")


def _cell(it: Outcome) -> str:
    if it.max is None:
        return "-"
    mark = "!" if it.over else "*" if it.own_rule else ""
    return f"{it.max:.0e}{mark}" if it.max else f"0{mark}"
