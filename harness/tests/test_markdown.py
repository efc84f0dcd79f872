"""The summary of a run for a pull request."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import pytest
from command_line import call
from small_runs import sky

from crosstrace.harness import markdown
from crosstrace.harness.session import RunOptions, run
from crosstrace.harness.sources import Source

NASTY = "| # *bold* [x](http://a) <b>@all</b>\n\n- `code`"
LANES = ("fake_lanes:Plain", "fake_lanes:Gradient", "fake_lanes:Absent")


@pytest.fixture(scope="module")
def report(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """Give the record of a run with a scene that departs."""
    out = tmp_path_factory.mktemp("markdown") / "out"
    made = run([Source(NASTY, sky())], out, RunOptions(LANES, jobs=2, timeout_s=60))
    assert (out / "report.md").read_text(encoding="utf-8") == markdown.document(made)
    return made


def test_what_departs_and_what_is_missing_is_said_first(report: dict[str, Any]) -> None:
    """In the headline, and in words before the table."""
    text = markdown.document(report)
    assert "1 of 1 scenes came out otherwise than expected" in text.splitlines()[0]
    before = text[: text.index("<details>")]
    assert "wrong on 192 pixels" in before
    assert "no such program" in before


def test_no_character_of_a_name_is_markup(report: dict[str, Any]) -> None:
    """Each is escaped, and none breaks a line or a cell."""
    text = markdown.document(report)
    assert "<b>" not in text and "[x](" not in text
    rows = [line for line in text.splitlines() if line.startswith("|")]
    assert len({len(re.findall(r"(?<!\\)\|", row)) for row in rows}) == 1


def test_a_run_as_expected_says_so(report: dict[str, Any]) -> None:
    """Nothing else stands before the table."""
    (whole,) = report["scenes"]
    fine = {"verdict": "agree", "blame": [], "renderers": whole["renderers"][:1], "pairs": []}
    scene = {**whole, **fine}
    text = markdown.document({**report, "scenes": [scene] * 2})
    assert text.startswith("### crosstrace: all 2 scenes came out as expected")


def test_the_command_prints_it(report: dict[str, Any], tmp_path: Path) -> None:
    """From a record alone, to standard output or a file."""
    file = tmp_path / "report.json"
    file.write_text(json.dumps(report), encoding="utf-8")
    told = call("report", file, "--markdown")
    assert told.returncode == 0 and told.stdout == markdown.document(report)
    assert call("report", file, "--markdown", "-o", tmp_path / "x.md").returncode == 0
    assert (tmp_path / "x.md").read_text(encoding="utf-8") == markdown.document(report)
