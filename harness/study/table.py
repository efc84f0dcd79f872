"""A study as tables of 80 columns: one for each kind of error, the cheapest points first."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from crosstrace.harness.study.experiment import Entry
from crosstrace.harness.study.points import KINDS

HEADER = ("", "renderer", "settings", "time", "±", "max", "RMSE", "p99.9", "8-bit", "rays")
NUMBERS = HEADER[3:]

#: What a mark before a point says.
LEGEND = "*: on the front of its kind. o: against the renderer's own declared rules."

#: Settings are cut to this, so that a line keeps within 80 columns.
_LONGEST = 18


@dataclass(frozen=True)
class Table:
    """One kind of error: what it is against, and rows for `HEADER`."""

    title: str
    rows: list[tuple[str, ...]]


def tables(entry: Entry) -> Iterator[Table]:
    """Give the tables of a scene, of the kinds that were measured."""
    for kind in KINDS:
        some = [point for point in entry.points if point["kind"] == kind]
        if some:
            some.sort(key=lambda point: point["seconds"])
            yield Table(_title(kind, entry), [_row(point) for point in some])


def _title(kind: str, entry: Entry) -> str:
    facts = entry.references
    if kind == "depth":
        return f"depth, against {facts['deep']['max_depth']} bounces"
    if kind == "sampling":
        average = facts["average"]
        error = average["standard_error_rmse"]
        return f"sampling, against the mean of {average['samples']:,} samples, itself ± {error:.1e}"
    left_out = facts["certified"]["undecidable"] + facts["certified"]["outside"]
    less = f", {left_out:,} undecidable pixels left out" if left_out else ""
    if kind == "certified":
        return f"certified: half the width of the enclosure{less}"
    return f"{kind}, against the certified value{less}"


def _row(point: dict[str, Any]) -> tuple[str, ...]:
    error = point["error"]
    label = point["label"]
    mark = "*" if point["pareto"] else "o" if point["own_rules"] else ""
    percent = 100 * point["spread"] / point["seconds"] if point["seconds"] else 0.0
    return (
        mark, point["renderer"],
        label if len(label) <= _LONGEST else label[: _LONGEST - 1] + "…",
        time_text(point["seconds"]), f"{min(percent, 999):.0f}%",
        *(_short(error[key]) for key in ("max", "rmse", "p999")),
        "-" if error["wrong_8bit"] is None else _count(error["wrong_8bit"]),
        "-" if point["rays"] is None else _count(point["rays"]),
    )  # fmt: skip


def time_text(seconds: float) -> str:
    """Write a time in few characters: 4.1ms, 0.123ms, 231ms, 1.23s."""
    if seconds < 0.9995:
        return f"{1e3 * seconds:.3g}ms"
    return f"{seconds:.3g}s" if seconds < 999.5 else f"{seconds:.0f}s"


def _short(value: float | None) -> str:
    """Write an error in at most six characters: 4.1e-3 for 0.0041."""
    if value is None:
        return "-"
    if value == 0:
        return "0"
    mantissa, _, exponent = f"{value:.1e}".partition("e")
    return f"{mantissa}e{int(exponent)}"


def _count(value: int) -> str:
    """Write a count in at most five characters: 12345, 1.2M."""
    for size, unit in ((1e9, "G"), (1e6, "M"), (1e3, "k")):
        if value >= 100 * size or value >= size > 1e3:
            return f"{value / size:.3g}{unit}"
    return str(value)
