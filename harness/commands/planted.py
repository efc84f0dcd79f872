"""`crosstrace check --faults`: the table fault × scene × caught."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from string import ascii_lowercase, ascii_uppercase
from typing import TYPE_CHECKING, Any

from crosstrace.harness import console

if TYPE_CHECKING:
    from crosstrace.harness.mutation import Row
    from crosstrace.harness.session import RunOptions
    from crosstrace.harness.sources import Source

NAME = "mutation.json"

#: Scenes side by side in the table, which is 80 columns wide.
_ABREAST = 25

_LETTERS = ascii_lowercase + ascii_uppercase


def plant(
    sources: list[Source], how: RunOptions, output: Path | None, as_json: bool, quiet: bool
) -> int:
    """Plant the catalogue of faults, print the table, keep it in a folder; return the status."""
    from crosstrace.harness import fault_proof, images, record

    what = f"faults planted in scenes: {len(sources)}, renderers: {', '.join(how.lanes)}"
    with console.progress(quiet, what) as bar:

        def observe(done: int, total: int, row: Row) -> None:
            escaped = fault_proof.state(row.record()) == "escaped"
            text = f"{row.scene} {row.lane} {row.fault}" + (": not caught" if escaped else "")
            bar.update(done, total, text, escaped)

        made = fault_proof.prove(sources, how, events=observe)
    if output is not None:
        output.mkdir(parents=True, exist_ok=True)
        images.write_bytes(output / NAME, record.dumps(made).encode())
    if as_json:
        console.json_result(made)
    else:
        _print(made, quiet)
        if output is not None and not quiet:
            console.result(f"\ntable: {output / NAME}")
    return fault_proof.exit_status(made)


def _print(made: Mapping[str, Any], quiet: bool) -> None:
    from crosstrace.harness import fault_proof

    rows = made["rows"]
    if not quiet:
        names = [scene["name"] for scene in made["scenes"]]
        for first in range(0, len(names), _ABREAST):
            _print_table(made["faults"], names[first : first + _ABREAST], rows)
        console.result("number: lanes in which it was caught and blamed; ! it escaped in one,")
        console.result("? one failed; - it changes too little; no mark: nothing to break\n")
    for row in rows:
        who = f"{row['scene']}: {row['fault']} in {row['lane']}"
        if fault_proof.state(row) == "failed":
            console.result(f"{who} failed: {row['error']}")
        elif fault_proof.state(row) == "escaped":
            how = "blamed on another" if row["caught"] else "not caught"
            console.result(f"{who} changes {row['changed']:,} pixels and is {how}")
    counts = {key: sum(scene[key] for scene in made["scenes"]) for key in ("judged", "caught")}
    blamed = sum(scene["blamed"] for scene in made["scenes"])
    console.result(f"{len(made['faults'])} faults, {len(made['scenes'])} scenes: "
                   f"{counts['judged']} plantings judged, {counts['caught']} caught, "
                   f"{blamed} blamed on their lane")  # fmt: skip


def _print_table(
    faults: Mapping[str, str], scenes: Sequence[str], rows: Sequence[Mapping[str, Any]]
) -> None:
    letters = dict(zip(scenes, _LETTERS, strict=False))
    legend = ", ".join(f"{letter} {name}" for name, letter in letters.items())
    console.result(_folded(legend))
    of_each: dict[tuple[str, str], list[Mapping[str, Any]]] = {}
    for row in rows:
        of_each.setdefault((row["fault"], row["scene"]), []).append(row)
    table = [
        (fault, *(_cell(of_each.get((fault, scene), ())) for scene in scenes)) for fault in faults
    ]
    console.table(("fault", *letters.values()), table, right=tuple(letters.values()))


def _cell(rows: Sequence[Mapping[str, Any]]) -> str:
    from crosstrace.harness import fault_proof

    states = [fault_proof.state(row) for row in rows]
    if "escaped" in states:
        return "!"
    if "failed" in states:
        return "?"
    if caught := states.count("caught"):
        return str(caught)
    return "-" if "too little" in states else ""


def _folded(text: str) -> str:
    from textwrap import fill

    return fill(text, console.WIDTH)
