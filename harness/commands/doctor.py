"""`crosstrace doctor`: which renderers work here, and how to install what is missing."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from crosstrace.harness.commands import options

if TYPE_CHECKING:
    from crosstrace.translators.renderer import Probe


@click.command(name="doctor")
@click.option("--renderers", metavar="A,B", help="Only these renderers.")
@options.as_json
def command(renderers: str | None, as_json: bool) -> int:
    """Look for every renderer; the exit status is 3 where one is missing."""
    from crosstrace.harness import console, environment, lanes, record

    probes = _probes(lanes.chosen(renderers))
    complete = all(probe.available for probe in probes.values())
    if as_json:
        entries = [
            {**record.probe_entry(lane, probe), "details": dict(probe.details)}
            for lane, probe in probes.items()
        ]
        console.print_json({"environment": environment.describe(), "renderers": entries})
        return 0 if complete else 3
    rows = [
        [lane, "works" if probe.available else "missing", probe.version or "–",
         ", ".join(f"{k} {v}" for k, v in probe.details.items())]
        for lane, probe in probes.items()
    ]  # fmt: skip
    click.echo(console.table(["renderer", "", "version", "details"], rows, left=4))
    for lane, probe in probes.items():
        if not probe.available:
            click.echo(f"\n{lane}: {probe.reason}")
            if probe.remedy:
                click.echo(f"  install it with: {probe.remedy}")
    return 0 if complete else 3


def _probes(chosen: tuple[str, ...]) -> dict[str, Probe]:
    """Ask all lanes at once, each in a process of its own."""
    from crosstrace.harness import tasks
    from crosstrace.harness.jobs import Task, WorkerPool
    from crosstrace.harness.session import PROBE_TIMEOUT_S
    from crosstrace.translators.errors import RendererError
    from crosstrace.translators.renderer import Probe

    with WorkerPool(len(chosen)) as pool:
        futures = {
            lane: pool.submit(
                Task(tasks.probe, lane, timeout_s=PROBE_TIMEOUT_S, label="looking for it"), lane
            )
            for lane in chosen
        }
        probes = {}
        for lane, future in futures.items():
            try:
                probes[lane] = future.result()
            except RendererError as error:
                probes[lane] = Probe(False, reason=str(error))
        return probes
