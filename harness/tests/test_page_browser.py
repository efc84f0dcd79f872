"""The report page as a whole, in a real browser: its first screen, its keys, what it may do."""

from __future__ import annotations

import json
import shlex
from pathlib import Path
from typing import Any
from urllib.parse import quote

import pytest
from opened_page import NASTY, PLAIN, Opened, entry, levels
from playwright.sync_api import Browser

from crosstrace.harness.page import draw


def test_the_page_opens_from_a_file_without_a_network(opened: Opened) -> None:
    """What departs comes first, in words and with a picture, and nothing is complained about."""
    page = opened.go()
    names = page.locator(".card h2 a").all_inner_texts()
    assert names[0] == "bolha2" and set(names) == {"bolha2", "sky", NASTY}
    assert "wrong on" in page.locator(".card p").first.inner_text()
    assert page.evaluate("[...document.images].every((image) => image.naturalWidth > 0)")


def test_names_stay_texts(opened: Opened) -> None:
    """Also those that a script puts in."""
    page = opened.go(f"scene={quote(NASTY, safe='')}")
    assert page.locator("section.scene:not([hidden]) h2").inner_text() == NASTY
    # The line to paste gives a shell the name as one word.
    words = shlex.split(page.locator("#inspector code").inner_text())
    assert words[:3] == ["crosstrace", "explain", f"{NASTY}.txt"]
    assert page.title().startswith("crosstrace")
    assert page.evaluate("document.querySelectorAll('img[src=x]').length") == 0


def test_the_filter_survives_a_reload(opened: Opened) -> None:
    """So do the words that are searched for, and the scene that is open."""
    page = opened.go()
    visible = ".card:not([hidden]) h2 a"
    page.locator("[data-show=agree]").click()
    assert set(page.locator(visible).all_inner_texts()) == {"sky", NASTY}
    page.locator("#find").fill("sky")
    page.reload()
    page.wait_for_selector("body[data-ready]")
    assert page.locator(visible).all_inner_texts() == ["sky"]
    assert page.locator("[data-show=agree]").get_attribute("aria-pressed") == "true"
    assert page.locator("#find").input_value() == "sky"
    page.locator(visible).click()
    page.wait_for_selector("#viewer[data-ready=sky]")
    page.reload()
    page.wait_for_selector("#viewer[data-ready=sky]")
    page.go_back()
    page.locator("#overview").wait_for()
    assert page.locator(visible).all_inner_texts() == ["sky"]


def test_the_keyboard_alone_reaches_everything(opened: Opened) -> None:
    """Tab to a scene, Enter, digits, a held Shift, arrows, and Escape back to all scenes."""
    page = opened.go()
    for _ in range(30):
        page.keyboard.press("Tab")
        if page.evaluate("document.activeElement.dataset.open") == "bolha2":
            break
    page.keyboard.press("Enter")
    page.wait_for_selector("#viewer[data-ready=bolha2]")
    pressed = "#images [aria-pressed=true]"
    page.keyboard.press("2")
    assert page.locator(pressed).get_attribute("data-lane") == PLAIN
    page.evaluate("ct.viewer.cursor = null; ct.viewer.redraw()")
    x, y = (0.5 * side for side in opened.size())
    at = opened.pixel_at(x, y)
    native, plain = (levels(opened.folder, lane)[at].tolist() for lane in (0, 1))
    assert native != plain and opened.color(x, y) == plain
    page.keyboard.down("Shift")
    assert opened.color(x, y) == native
    page.keyboard.up("Shift")
    assert opened.color(x, y) == plain
    for _ in range(60):
        page.keyboard.press("Tab")
        if page.evaluate("document.activeElement.id") == "view":
            break
    page.evaluate("ct.viewer.look({ row: 5, col: 6 }, true)")
    page.keyboard.press("ArrowDown")
    page.keyboard.press("ArrowRight")
    page.keyboard.press("Shift+ArrowRight")
    title = page.locator("#inspector h3")
    assert (title.get_attribute("data-row"), title.get_attribute("data-col")) == ("6", "17")
    page.keyboard.press("Escape")
    page.locator("#overview").wait_for()


def test_focus_is_always_seen(opened: Opened) -> None:
    """Whatever Tab reaches has an outline."""
    page = opened.glass()
    reached = set()
    for _ in range(40):
        page.keyboard.press("Tab")
        name, outline = page.evaluate(
            "(() => { const e = document.activeElement, s = getComputedStyle(e); return"
            " [e === document.body ? '' : e.id || e.textContent,"
            " `${s.outlineStyle} ${s.outlineWidth}`]; })()"
        )
        if name:
            reached.add(name)
            assert not outline.startswith("none") and not outline.endswith(" 0px"), name
    assert {"view", "layer", "mode", "inspector"} <= reached


def test_the_tolerance_shows_what_would_pass(opened: Opened) -> None:
    """Counts are those of the record, and the line to paste has the number."""
    page = opened.go()
    slider = page.locator("#tolerance")
    slider.focus()
    assert "2 of 3 scenes would pass" in page.locator("#would").inner_text()
    for _ in range(6):
        page.keyboard.press("PageUp")
    tolerance = float(page.locator("#tolerance-value").inner_text())
    assert tolerance > 0
    excess = entry(opened.folder)["renderers"][1]["excess"]
    left = sum(
        spread["beyond"] + sum(n for edge, n in spread["counts"].items() if float(edge) > tolerance)
        for spread in excess.values()
    )
    cells = page.locator('#play-rows tr[data-name="bolha2"] td').all_inner_texts()
    assert int(cells[1].split(" ")[0].replace("\u202f", "")) == left
    assert (
        f"--tolerance {page.locator('#tolerance-value').inner_text()}"
        in page.locator("#play-lines").inner_text()
    )
    page.keyboard.press("End")
    assert "3 of 3 scenes would pass" in page.locator("#would").inner_text()
    kept = page.locator("#tolerance-value").inner_text()
    page.reload()
    page.wait_for_selector("body[data-ready]")
    assert page.locator("#tolerance-value").inner_text() == kept


def test_no_tolerance_mends_a_broken_reference(
    browser: Browser, report_folder: Path, tmp_path: Path
) -> None:
    """A scene whose float128 value leaves its enclosure passes with none."""
    report = json.loads((report_folder / "report.json").read_text(encoding="utf-8"))
    for scene in report["scenes"]:
        if scene["name"] == "sky":
            scene |= {"verdict": "reference-broken", "blame": ["native"]}
            scene["judgement"]["truth"]["float128_outside"] = 1
    (tmp_path / "report.html").write_text(draw.page(report, report_folder), encoding="utf-8")
    made = Opened(browser, tmp_path)
    page = made.go()
    page.locator("#tolerance").press("End")
    assert "2 of 3 scenes would pass" in page.locator("#would").inner_text()
    assert "fails" in page.locator('#play-rows tr[data-name="sky"]').inner_text()
    made.context.close()


def test_printed_every_scene_is_there(opened: Opened) -> None:
    """Not only what was open."""
    page = opened.go("scene=sky")
    page.evaluate("dispatchEvent(new Event('beforeprint'))")
    assert page.locator("section.scene:visible").count() == 3
    page.evaluate("dispatchEvent(new Event('afterprint'))")
    assert page.locator("section.scene:visible").count() == 1


def test_no_other_script_runs(browser: Browser, report_folder: Path) -> None:
    """The page's policy knows its own script by its hash."""
    made = Opened(browser, report_folder)
    page = made.go()
    page.evaluate("const s = document.createElement('script'); s.textContent = 'window.broken = 1';"
                  " document.body.append(s)")  # fmt: skip
    assert page.evaluate("window.broken") is None
    assert any("Content Security Policy" in text for text in made.complaints)
    made.context.close()


def test_without_a_script_all_is_there_but_the_viewer(
    browser: Browser, report_folder: Path
) -> None:
    """Verdicts, numbers and plots are plain HTML."""
    context = browser.new_context(java_script_enabled=False, offline=True)
    page = context.new_page()
    page.goto((report_folder / "report.html").as_uri())
    assert page.locator("section.scene:visible").count() == 3
    assert page.locator("svg.plot:visible").count() >= 2
    assert not page.locator("#viewer").is_visible()
    context.close()


@pytest.mark.parametrize(("width", "scheme"), [(400, "light"), (800, "dark"), (1900, "dark")])
def test_nothing_sticks_out_of_the_window(
    browser: Browser, report_folder: Path, width: int, scheme: Any
) -> None:
    """Wide tables scroll by themselves; the page does not."""
    made = Opened(browser, report_folder)
    made.page.set_viewport_size({"width": width, "height": 900})
    made.page.emulate_media(color_scheme=scheme)
    for hash_ in ("", "scene=bolha2"):
        page = made.go(hash_)
        assert page.evaluate("document.documentElement.scrollWidth") <= width
    made.context.close()
