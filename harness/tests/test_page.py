"""The report page: well-formed, safe with any name, alone on a machine without a network."""

from __future__ import annotations

import json
import re
from collections import Counter
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote

import pytest
from small_runs import sky

from crosstrace.harness.page import draw
from crosstrace.harness.session import RunOptions, run
from crosstrace.harness.sources import Source

LANES = ("fake_lanes:Gradient", "fake_lanes:Brighter", "fake_lanes:Absent", "fake_lanes:Undefined")
NASTY = "<script>alert('x')</script>&\"%s/../é"
VOID = {"meta", "link", "img", "br", "hr", "input", "col"}


class _Reader(HTMLParser):
    """Keeps the elements and complains where tags do not nest."""

    def __init__(self, text: str) -> None:
        super().__init__(convert_charrefs=True)
        self.elements: list[tuple[str, dict[str, str]]] = []
        self.text = ""
        self._open: list[str] = []
        self.feed(text)
        self.close()
        assert self._open == []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.elements.append((tag, {name: value or "" for name, value in attrs}))
        if tag not in VOID:
            self._open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self._open.pop() == tag

    def handle_data(self, data: str) -> None:
        self.text += data


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Give the directory of a report with names and renderers that try to break it."""
    out = tmp_path_factory.mktemp("page") / "out"
    sources = [
        Source(NASTY, sky(), title=NASTY, about=NASTY, packaged=True),
        Source("tiny", sky().resized(1, 1)),
    ]
    run(sources, out, RunOptions(LANES, jobs=2, timeout_s=60))
    return out


@pytest.fixture(scope="module")
def page(folder: Path) -> _Reader:
    """Give the page, read."""
    return _Reader((folder / "report.html").read_text(encoding="utf-8"))


def test_every_element_is_closed_and_ids_are_unique(page: _Reader) -> None:
    """Nothing is left to the browser's guessing."""
    ids = Counter(attributes["id"] for _, attributes in page.elements if "id" in attributes)
    assert ids
    assert max(ids.values()) == 1
    targets = {a["href"][1:] for _, a in page.elements if a.get("href", "").startswith("#")}
    assert targets <= set(ids)


def test_names_are_text_and_never_markup(page: _Reader) -> None:
    """A scene, a message or a declaration with tags in it is shown as it is."""
    assert not any(tag == "script" for tag, _ in page.elements)
    assert NASTY in page.text
    assert "there is none <b>at all</b>" in page.text
    assert "no such program <script>" in page.text


def test_nothing_is_loaded_from_a_network(folder: Path, page: _Reader) -> None:
    """Every address is relative and its file is there."""
    text = (folder / "report.html").read_text(encoding="utf-8")
    assert not re.search(r"https?:|//[a-z]|@import|url\(", text)
    for _, attributes in page.elements:
        for name in ("src", "href"):
            address = attributes.get(name, "#")
            if not address.startswith("#"):
                assert (folder / unquote(address)).is_file(), address


def test_pictures_have_a_text_in_their_place(page: _Reader) -> None:
    """An empty one marks a mere decoration."""
    pictures = [attributes for tag, attributes in page.elements if tag == "img"]
    assert pictures
    assert all("alt" in attributes for attributes in pictures)
    assert any(NASTY in attributes["alt"] for attributes in pictures)


def test_the_page_tells_what_is_missing_and_what_to_do(page: _Reader) -> None:
    """A renderer that gave no image is named with its remedy, and nothing passes for it."""
    assert "2 of 2 scenes are incomplete" in page.text
    assert "apt-get install it" in page.text
    assert "incomplete" in page.text


def test_packaged_scenes_are_said_to_be_compositions_of_this_project(folder: Path) -> None:
    """Only where there are any."""
    report = json.loads((folder / "report.json").read_text(encoding="utf-8"))
    assert "own compositions" in draw.page(report)
    report["scenes"] = report["scenes"][1:]
    assert "own compositions" not in draw.page(report)


def test_the_page_is_drawn_from_the_record_alone(folder: Path) -> None:
    """Drawn again, it is the same to the last byte."""
    report = json.loads((folder / "report.json").read_text(encoding="utf-8"))
    assert draw.page(report) == (folder / "report.html").read_text(encoding="utf-8")


def test_the_page_has_a_dark_side_and_a_printed_one(folder: Path) -> None:
    """Light or dark as the reader's system is."""
    text = (folder / "report.html").read_text(encoding="utf-8")
    assert "prefers-color-scheme: dark" in text
    assert "@media print" in text
