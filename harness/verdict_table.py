"""The table scene × lane × class of all goldens of a folder, as a document for people."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from crosstrace.harness import images
from crosstrace.harness.classes import NAMES
from crosstrace.harness.goldens import Golden, Reference

FILE = "VERDICTS.md"

_INTRODUCTION = """\
# Verdicts: scene × renderer × class

Pixels of each class for every scene that has a golden here, as accepted. Made by `crosstrace
bless`; `crosstrace check` fails where they change for the worse. What the classes mean stands in
the README.
"""


def write(reference: Reference, order: list[str]) -> Path:
    """Write the table into the folder of goldens: scenes in this order, others after them."""
    names = sorted(
        (path.stem for path in reference.folder.glob("*.npz")),
        key=lambda name: (order.index(name) if name in order else len(order), name),
    )
    found = [golden for name in names if (golden := reference.read(name)) is not None]
    target = reference.folder / FILE
    images.write_bytes(target, markdown(found).encode())
    return target


def markdown(goldens: list[Golden]) -> str:
    """Return the document; zeros are left out of the table, to be read at a glance."""
    return "\n".join([_INTRODUCTION, *_versions(goldens), "", *_rows(goldens), ""])


def _versions(goldens: list[Golden]) -> Iterator[str]:
    seen = dict.fromkeys(
        f"{lane['name']} {lane['version']}" for golden in goldens for lane in golden.about["lanes"]
    )
    yield f"Renderers: {', '.join(seen)}."


def _rows(goldens: list[Golden]) -> Iterator[str]:
    yield f"| scene | verdict | blamed | renderer | {' | '.join(NAMES)} |"
    yield "|---|---|---|---|" + "---:|" * len(NAMES)
    for golden in goldens:
        about = golden.about
        scene = [about["name"], about["verdict"], ", ".join(about["blame"])]
        for lane in about["lanes"]:
            counts = [_count(lane["classes"][name]) for name in NAMES]
            yield f"| {' | '.join([*scene, lane['name'], *counts])} |"
            scene = ["", "", ""]


def _count(value: int | None) -> str:
    if value is None:
        return "–"
    return f"{value:,}" if value else ""
