"""`crosstrace doctor`: which renderers work here, and how to install what is missing."""

from __future__ import annotations

import click

from crosstrace.harness.cli import RENDERER
from crosstrace.harness.commands import options


@click.command()
@options.renderers
@options.json_output
@click.pass_context
def command(ctx: click.Context, renderers: str | None, as_json: bool) -> None:
    """Say which renderers work here. Ends with status 3 where one is missing."""
    from crosstrace.harness.lanes import chosen

    lanes = chosen(renderers)
    from crosstrace.harness import console, environment, record, tasks
    from crosstrace.harness.jobs import Task, WorkerPool
    from crosstrace.translators.renderer import Probe

    found = []
    with WorkerPool(len(lanes)) as pool:
        futures = [
            pool.submit(Task(tasks.probe, affinity=lane, timeout_s=120, label=lane), lane)
            for lane in lanes
        ]
        for lane, future in zip(lanes, futures, strict=True):
            error = future.exception()
            probe = Probe(False, reason=str(error)) if error else future.result()
            found.append({"name": lane, **vars(probe), "details": dict(probe.details)})
    answer = {"environment": environment.describe(), "renderers": found}
    if as_json:
        click.echo(record.dumps(answer), nl=False)
    else:
        console.doctor(answer)
    if not all(entry["available"] for entry in found):
        ctx.exit(RENDERER)
