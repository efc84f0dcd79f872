"""A record as Markdown: the summary that a pull request shows.

It has what a reviewer asks first: how many scenes came out how, what departs and why, the greatest
difference of each renderer. Names and messages are users', so that no character of them is markup.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from typing import Any

from crosstrace.harness.outcome import outcome, sentence
from crosstrace.harness.summary import by_scene, failures

#: More scenes than this are not listed one by one unless they depart: hosts cut long comments.
_LISTED = 60

_MARKUP = re.compile(r"([\\`*_{}\[\]<>#|!~@&$^:-])")


def document(report: Mapping[str, Any]) -> str:
    """Return the Markdown of a run's record (`record.report`)."""
    return "\n".join(_lines(report)) + "\n"


def _lines(report: Mapping[str, Any]) -> Iterator[str]:
    scenes = report["scenes"]
    departing = [scene for scene in scenes if outcome(scene) == "departs"]
    incomplete = [scene for scene in scenes if outcome(scene) == "incomplete"]
    yield f"### crosstrace: {_headline(len(scenes), len(departing), len(incomplete))}"
    yield ""
    environment, run = report["environment"], report["run"]
    versions = ", ".join(
        f"{text(about['name'])} {text(about['version'] or 'missing')}"
        for about in environment["renderers"]
    )
    yield f"{versions}; {text(environment['cpu'])}; {text(run['created'])}"
    yield ""
    for scene in (*departing, *incomplete):
        yield f"- **{text(scene['name'])}**: {text(sentence(scene))}"
    for failure in failures(report):
        yield f"- {text(failure)}"
    if departing or incomplete:
        yield ""
    if scenes and len(scenes) <= _LISTED:
        yield "<details><summary>All scenes</summary>"
        yield ""
        yield from _table(report)
        yield ""
        yield "</details>"


def _headline(scenes: int, departing: int, incomplete: int) -> str:
    said = []
    if departing:
        said.append(f"{departing} of {scenes} scenes came out otherwise than expected")
    if incomplete:
        said.append(f"{incomplete} of {scenes} scenes incomplete")
    return ", ".join(said) or f"all {scenes} scenes came out as expected"


def _table(report: Mapping[str, Any]) -> Iterator[str]:
    header, rows, numbers = by_scene(report)
    yield f"| {' | '.join(text(cell) for cell in header)} |"
    yield f"|{'|'.join('---:' if cell in numbers else '---' for cell in header)}|"
    for row in rows:
        yield f"| {' | '.join(text(cell) for cell in row)} |"


def text(value: str) -> str:
    """Return a text of one line in which no character means anything to Markdown."""
    return _MARKUP.sub(r"\\\1", " ".join(value.split()))
