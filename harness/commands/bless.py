"""`crosstrace bless`: new results accepted into the regression suite."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from crosstrace.harness import console
from crosstrace.harness.commands import options


@click.command("bless")
@click.argument("scenes", nargs=-1, metavar="[SCENE]...")
@click.option("--all", "everything", is_flag=True,
              help="All packaged scenes, or all of --reference.")  # fmt: skip
@click.option("--reason", required=True, help="Why these results are right; it is kept.")
@options.reference
@options.renderers
@options.scene_options
@options.threads
@options.timeout
@options.jobs
@options.as_json
@options.quiet
def command(
    scenes: tuple[str, ...],
    everything: bool,
    reason: str,
    reference: Path | None,
    renderers: str | None,
    size: tuple[int, int] | None,
    delivery: int | None,
    threads: int,
    timeout: float,
    jobs: int | None,
    as_json: bool,
    quiet: bool,
) -> int:
    """Render scenes and accept what comes out as what `crosstrace check` expects from now on.

    A scene that came out as before is left alone. Nothing is accepted where a renderer is missing
    (exit status 3) or where the verdict is that the reference is broken (1).
    """
    from crosstrace.harness import outcome, regression
    from crosstrace.harness.goldens import located
    from crosstrace.harness.lanes import chosen
    from crosstrace.harness.session import RunOptions
    from crosstrace.translators.errors import UsageError

    if bool(scenes) == everything:
        raise UsageError("expected either scenes or --all")
    if not reason.strip():
        raise UsageError("--reason: expected why these results are right, found nothing")
    lanes = chosen(renderers)
    where = located(reference)
    where.check_writable()
    sources = options.suite(scenes, reference, delivery, size)
    how = RunOptions(lanes, jobs or 0, threads, timeout)
    with console.progress(quiet, f"scenes: {len(sources)}, renderers: {', '.join(lanes)}") as bar:
        done = regression.bless(sources, where, reason, how, events=console.observer(bar))
    if as_json:
        console.json_result({"scenes": done})
    else:
        _print(done, where.folder, quiet)
    statuses = {scene["status"] for scene in done}
    if "refused" in statuses:
        return outcome.DISAGREES
    return outcome.RENDERER_FAILED if "incomplete" in statuses else outcome.OK


def _print(done: list[dict[str, Any]], folder: Path, quiet: bool) -> None:
    for scene in done:
        if scene["status"] in ("refused", "incomplete"):
            console.result(
                f"{scene['name']}: {scene['status']}, left as it was. {scene['message']}"
            )
        elif not quiet:
            size = f", {scene['bytes'] / 1024:.0f} KiB" if scene["bytes"] else ""
            console.result(f"{scene['name']}: {scene['status']}, {scene['verdict']}{size}")
    written = [scene["bytes"] for scene in done if scene["bytes"]]
    total = f"{len(written)} goldens written, {sum(written) / 1024:.0f} KiB: {folder}"
    console.note(total, quiet)
