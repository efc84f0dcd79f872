"""`crosstrace doctor`: which renderers work here, and how to install what is missing."""

from __future__ import annotations

from dataclasses import asdict
from typing import TYPE_CHECKING

import click

from crosstrace.harness import console
from crosstrace.harness.commands import options

if TYPE_CHECKING:
    from crosstrace.translators.renderer import Probe


@click.command("doctor")
@options.renderers
@options.as_json
@options.quiet
def command(renderers: str | None, as_json: bool, quiet: bool) -> int:
    """Say which renderers work here, their versions, and what to install.

    The exit status is 3 where one of them is missing.
    """
    from crosstrace.harness.environment import describe
    from crosstrace.harness.lanes import chosen
    from crosstrace.harness.outcome import OK, RENDERER_FAILED

    lanes = chosen(renderers)
    found = _probe(lanes, quiet)
    if as_json:
        rows = [{"name": lane, **asdict(probe)} for lane, probe in found.items()]
        console.json_result({"environment": describe(), "renderers": rows})
    else:
        _print(found)
    return OK if all(probe.available for probe in found.values()) else RENDERER_FAILED


def _probe(lanes: tuple[str, ...], quiet: bool) -> dict[str, Probe]:
    from crosstrace.harness import alone
    from crosstrace.translators.errors import RendererError
    from crosstrace.translators.renderer import Probe

    found = {}
    with console.progress(quiet, "looking for renderers") as bar:
        for done, lane in enumerate(lanes, 1):
            try:
                found[lane] = alone.probe(lane)
            except RendererError as error:
                found[lane] = Probe(False, reason=str(error))
            works = found[lane].available
            bar.update(done, len(lanes), f"{lane} {'ok' if works else 'missing'}", not works)
    return found


def _print(found: dict[str, Probe]) -> None:
    rows = []
    for lane, probe in found.items():
        details = ", ".join(f"{name}: {value}" for name, value in probe.details.items())
        status = "ok" if probe.available else "missing"
        rows.append((lane, status, probe.version, details or probe.reason))
    console.table(("renderer", "status", "version", "details"), rows)
    for lane, probe in found.items():
        if not probe.available:
            console.result(f"\n{lane}: {probe.reason}")
            if probe.remedy:
                console.result(f"  install it with: {probe.remedy}")
