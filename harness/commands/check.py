"""`crosstrace check`: the regression suite."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from crosstrace.harness import console
from crosstrace.harness.commands import options

if TYPE_CHECKING:
    from crosstrace.harness.session import RunOptions


@click.command("check")
@click.argument("scenes", nargs=-1, metavar="[SCENE]...")
@options.reference
@click.option("-o", "--output", metavar="DIR", type=click.Path(path_type=Path),
              help="Keep the report of this run, and check.json.")  # fmt: skip
@options.junit
@click.option("--faults", is_flag=True,
              help="Prove the suite: plant faults, and say which are caught.")  # fmt: skip
@options.renderers
@options.scene_options
@options.threads
@options.timeout
@options.jobs
@options.as_json
@options.quiet
def command(
    scenes: tuple[str, ...],
    reference: Path | None,
    output: Path | None,
    junit: Path | None,
    faults: bool,
    renderers: str | None,
    size: tuple[int, int] | None,
    delivery: int | None,
    threads: int,
    timeout: float,
    jobs: int | None,
    as_json: bool,
    quiet: bool,
) -> int:
    """Render scenes again and hold them against their goldens, class by class and pixel by pixel.

    Without a SCENE it takes all packaged ones, or those in the folder of --reference. A scene
    without a golden fails, and its golden is made. The exit status is 1 where something changed
    that rounding does not explain, 3 where a renderer is missing or failed.

    With --faults every fault of a catalogue is planted in every renderer instead, on the packaged
    course scenes or those named, at 60 rows unless --size says otherwise. The exit status is 1
    where a fault that changes more than 20 pixels is not caught, or not blamed on its renderer.
    """
    from crosstrace.harness import regression
    from crosstrace.harness.goldens import located
    from crosstrace.harness.lanes import chosen
    from crosstrace.harness.publish import PAGE_NAME
    from crosstrace.harness.session import RunOptions

    lanes = chosen(renderers)
    how = RunOptions(lanes, jobs or 0, threads, timeout, size=size)
    if faults:
        return _plant(scenes, (reference, junit), delivery, how, output, as_json, quiet)
    if junit is not None:
        options.check_target(junit)
    sources = options.suite(scenes, reference, delivery, size)
    with console.progress(quiet, f"scenes: {len(sources)}, renderers: {', '.join(lanes)}") as bar:
        checked = regression.check(
            sources, located(reference), how, out=output, events=console.observer(bar)
        )
    _write(checked, output, junit)
    if as_json:
        console.json_result(checked)
    else:
        _print(checked, quiet)
        if output is not None and not quiet:
            console.result(f"\nreport: {output / PAGE_NAME}")
    return regression.exit_status(checked)


def _plant(
    scenes: tuple[str, ...],
    others: tuple[Path | None, ...],
    delivery: int | None,
    how: RunOptions,
    output: Path | None,
    as_json: bool,
    quiet: bool,
) -> int:
    from crosstrace.harness.commands.planted import plant
    from crosstrace.harness.sources import find
    from crosstrace.translators.errors import UsageError

    if any(others):
        raise UsageError("--faults: expected neither --reference nor --junit with it")
    if output is not None:
        options.check_directory(output)
    return plant(find(scenes, delivery=delivery), how, output, as_json, quiet)


def _write(checked: dict[str, Any], output: Path | None, junit: Path | None) -> None:
    from crosstrace.harness import images, record
    from crosstrace.harness.junit import document

    files = {}
    if output is not None:
        files[output / "check.json"] = record.dumps(checked).encode()
    if junit is not None:
        files[junit] = document(checked)
    for path, content in files.items():
        images.write_bytes(path, content)


def _print(checked: dict[str, Any], quiet: bool) -> None:
    from crosstrace.harness.regression import told

    scenes = checked["scenes"]
    for scene in scenes:
        noted = [change for change in scene["changes"] if not change["fails"]]
        if scene["status"] == "pass" and (quiet or not noted):
            continue
        console.result(f"{scene['name']}: {scene['status']}")
        for change in scene["changes"]:
            if change["fails"] or not quiet:
                lane = f"{change['lane']}: " if change["lane"] else ""
                note = "" if change["fails"] else "note: "
                console.result(f"  {note}{lane}{change['text']}")
        if scene["absent"]:
            console.result(f"  {told(scene['absent'])}")
        if scene["status"] == "fail":
            console.result(f"  {scene['verdict']}. {scene['sentence']}")
    counts = ((word, sum(s["status"] == word for s in scenes)) for word in ("pass", "fail"))
    said = [f"{count} {word}" for word, count in counts]
    if incomplete := sum(s["status"] == "incomplete" for s in scenes):
        said.append(f"{incomplete} incomplete")
    console.result(f"{len(scenes)} scenes: {', '.join(said)}")
