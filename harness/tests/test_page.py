"""The report page: well-formed, safe with any name, alone on a machine without a network."""

from __future__ import annotations

import base64
import hashlib
import html
import json
import re
import shutil
from collections import Counter
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote

import numpy as np
import pytest
from small_runs import sky

from crosstrace.harness.page import draw, plots
from crosstrace.harness.page.payload import payload
from crosstrace.harness.session import RunOptions, run
from crosstrace.harness.sources import Source
from crosstrace.harness.spread import spread

LANES = ("fake_lanes:Gradient", "fake_lanes:Brighter", "fake_lanes:Absent", "fake_lanes:Undefined")
NASTY = "<script>alert('x')</script>&\"%s/../é"
VOID = {"meta", "link", "img", "br", "hr", "input", "col"}

#: The page's own script, and what it reads.
SCRIPTS = {"", "application/json"}


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
    # An empty one is the top of the page.
    assert targets <= {"", *ids}


def test_names_are_text_and_never_markup(folder: Path, page: _Reader) -> None:
    """A scene, a message or a declaration with tags in it is shown as it is."""
    assert NASTY in page.text
    assert "there is none <b>at all</b>" in page.text
    assert "no such program <script>" in page.text
    scripts = [attributes for tag, attributes in page.elements if tag == "script"]
    assert {attributes.get("type", "") for attributes in scripts} == SCRIPTS
    # One block a scene, one of constants, and one script.
    assert len(scripts) == 2 + 2
    assert not any(name.startswith("on") for _, attributes in page.elements for name in attributes)
    text = (folder / "report.html").read_text(encoding="utf-8")
    assert "alert('x')</script>" not in text


def test_the_policy_lets_only_the_own_script_run(folder: Path) -> None:
    """Its hash is that of the text between the tags, and nothing may be loaded."""
    text = (folder / "report.html").read_text(encoding="utf-8")
    script = text[text.rindex("<script>") + len("<script>") : text.rindex("</script>")]
    digest = base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()
    assert f"default-src 'none'; img-src data:; style-src 'unsafe-inline'; " \
           f"script-src 'sha256-{digest}'" in text  # fmt: skip


def test_nothing_is_loaded_from_a_network(folder: Path, page: _Reader) -> None:
    """What is shown is inside; what is linked is a file of the report."""
    text = (folder / "report.html").read_text(encoding="utf-8")
    assert not re.search(r"https?:|@import|url\(", text)
    for tag, attributes in page.elements:
        assert attributes.get("src", "data:").startswith("data:")
        address = attributes.get("href", "#")
        if not address.startswith("#"):
            assert tag == "a" and (folder / unquote(address)).is_file(), address


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
    assert "own compositions" in draw.page(report, folder)
    report["scenes"] = report["scenes"][1:]
    assert "own compositions" not in draw.page(report, folder)


def test_the_line_that_explains_a_pixel_names_the_scene_as_the_command_knows_it(
    folder: Path,
) -> None:
    """Every collection's scenes by name, others by a file's."""
    report = json.loads((folder / "report.json").read_text(encoding="utf-8"))
    scene = report["scenes"][1]
    for name, told in (("glass-bench", None), ("acne", None), ("mine", "mine.txt")):
        scene["name"] = name
        text = html.unescape(draw.page(report, folder))
        assert f'"crosstrace explain {told or name}"' in text, name


def test_the_page_is_drawn_from_the_record_and_its_files_alone(folder: Path) -> None:
    """Drawn again, it is the same to the last byte."""
    report = json.loads((folder / "report.json").read_text(encoding="utf-8"))
    assert draw.page(report, folder) == (folder / "report.html").read_text(encoding="utf-8")


def test_files_that_are_not_the_record_s_are_told_and_not_shown(
    folder: Path, tmp_path: Path
) -> None:
    """One that is missing, one that changed, and one outside of the report's folder."""
    shutil.copytree(folder, tmp_path / "copy")
    report = json.loads((folder / "report.json").read_text(encoding="utf-8"))
    scene = report["scenes"][1]
    first, second = (scene["renderers"][i]["images"]["png"] for i in (0, 1))
    (tmp_path / "copy" / first["file"]).unlink()
    with (tmp_path / "copy" / second["file"]).open("ab") as file:
        file.write(b"more")
    scene["images"]["pixels"]["file"] = "images/../../secret.json"
    (tmp_path / "secret.json").write_text("{}", encoding="utf-8")
    text = html.unescape(draw.page(report, tmp_path / "copy"))
    assert f"{first['file']} is not there" in text
    assert f"{second['file']} is not the file that the record names" in text
    assert "images/../../secret.json is not a file of this report" in text


def test_a_page_that_would_be_too_large_leaves_pictures_out_and_says_so(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What is worth looking at first has its pictures first."""
    report = json.loads((folder / "report.json").read_text(encoding="utf-8"))
    whole = draw.page(report, folder)
    sizes = [payload(scene, folder).size for scene in report["scenes"]]
    assert "too large" not in whole
    monkeypatch.setattr(draw, "LARGEST_PAYLOAD", sizes[0])
    cut = _Reader(draw.page(report, folder))
    assert cut.text.count("the page would be too large") == 1
    assert sum(tag == "img" for tag, _ in cut.elements) == 1


def test_a_study_is_shown_where_there_is_one(folder: Path) -> None:
    """Its picture as an image, so that no markup of a record gets into the page."""
    report = json.loads((folder / "report.json").read_text(encoding="utf-8"))
    error = {"max": 1e-3, "rmse": 1e-5, "p999": None, "wrong_8bit": 7}
    point = {"renderer": "native", "settings": {"precision": "f32"}, "seconds": 0.5,
             "error": error, "kind": NASTY, "pareto": True}  # fmt: skip
    svg = "<svg xmlns='http://www.w3.org/2000/svg'><script>alert('x')</script></svg>"
    study = {"points": [point], "advice": f"take {NASTY}", "svg": svg}
    for count in (len(report["scenes"]), 0):
        scenes = report["scenes"][:count]
        drawn = draw.page({**report, "scenes": scenes, "study": study}, folder)
        read = _Reader(drawn)
        assert f"take {NASTY}" in read.text and "precision=f32" in read.text
        assert svg not in drawn
        pictures = [a["src"] for tag, a in read.elements if tag == "img" and "svg" in a["src"]]
        assert [base64.b64decode(uri.partition(",")[2]).decode() for uri in pictures] == [svg]


def test_lines_of_plots_end_where_nothing_is_left() -> None:
    """The curve starts at what differs by more than the first edge and meets the axis."""
    pair = {"pixels": 100, "p999": 0.5, "spread": spread(np.array([0.0] * 90 + [1e-3] * 9 + [0.5]))}
    drawn = str(plots.curves(NASTY, [(NASTY, pair)]))
    assert "<script" not in drawn and "0.5" in drawn
    (points,) = re.findall(r'polyline[^>]*points="([^"]*)"', drawn)
    places = [tuple(map(float, place.split())) for place in points.split(",")]
    assert [x for x, _ in places] == sorted(x for x, _ in places)
    # One decade of shares is 25 high: 10 % above all edges below 1e-3, then 1 %, then nothing.
    heights = [y for _, y in places]
    assert heights == sorted(heights) and len(set(heights)) == 3
    nothing = {**pair, "p999": 0.0, "spread": spread(np.zeros(100))}
    assert 'points=""' in str(plots.curves("x", [("y", nothing)]))


def test_the_page_has_a_dark_side_and_a_printed_one(folder: Path) -> None:
    """Light or dark as the reader's system is."""
    text = (folder / "report.html").read_text(encoding="utf-8")
    assert "prefers-color-scheme: dark" in text
    assert "@media print" in text
