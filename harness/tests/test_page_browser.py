"""The report page in a real browser: headless Chromium opens it from a file, the network off.

The scenes are small. Two lanes that differ everywhere stand side by side: the native tracer, and
one that paints the background alone, so that left and right can be told apart.
"""

from __future__ import annotations

import json
import os
import shlex
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from urllib.parse import quote

import numpy as np
import pytest
from command_line import call
from playwright.sync_api import Browser, ConsoleMessage, Page, Request, sync_playwright
from small_runs import sky

from crosstrace.harness import images
from crosstrace.harness.page import draw
from crosstrace.harness.session import RunOptions, run
from crosstrace.harness.sources import Source, find

PLAIN = "fake_lanes:Plain"
ROWS, COLUMNS = 24, 32
NASTY = "<img src=x onerror=document.title='broken'>&\"%s/../é</script>"
BROWSERS = ("chromium", "chromium-browser", "google-chrome")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Give the directory of a report on a scene that departs and two that agree."""
    out = tmp_path_factory.mktemp("browser") / "out"
    sources = [Source("sky", sky()), Source(NASTY, sky(), title=NASTY), *find(["bolha2"])]
    run(sources, out, RunOptions(("native", PLAIN), jobs=2, timeout_s=60, size=(ROWS, COLUMNS)))
    return out


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    """Give a browser; without one the tests are skipped, except where one is required."""
    found = next(filter(None, map(shutil.which, BROWSERS)), None)
    if found is None:
        message = f"no browser: none of {', '.join(BROWSERS)} is installed"
        if os.environ.get("CROSSTRACE_REQUIRE_BROWSER"):
            pytest.fail(message)
        pytest.skip(message)
    with sync_playwright() as playwright:
        made = playwright.chromium.launch(executable_path=found)
        yield made
        made.close()


class Opened:
    """A report in a page of its own, with what it asked for and complained about."""

    def __init__(self, browser: Browser, folder: Path) -> None:
        """Open nothing yet."""
        self.folder = folder
        self.address = (folder / "report.html").as_uri()
        self.context = browser.new_context(
            offline=True, viewport={"width": 1400, "height": 1000}, reduced_motion="reduce"
        )
        self.page: Page = self.context.new_page()
        self.complaints: list[str] = []
        self.requests: list[str] = []
        self.page.on("console", self._said)
        self.page.on("pageerror", lambda error: self.complaints.append(str(error)))
        self.page.on("request", self._asked)

    def _said(self, message: ConsoleMessage) -> None:
        # Said of the tests' own reading of the canvas.
        readback = "willReadFrequently" in message.text
        if message.type in ("error", "warning") and not readback:
            self.complaints.append(message.text)

    def _asked(self, request: Request) -> None:
        if not request.url.startswith(("data:", "blob:")):
            self.requests.append(request.url)

    def go(self, hash_: str = "") -> Page:
        """Load the page, at a scene where the hash names one."""
        self.page.goto("about:blank")
        self.page.goto(f"{self.address}#{hash_}")
        self.page.wait_for_selector("body[data-ready]")
        if "scene=" in hash_:
            self.page.wait_for_selector("#viewer[data-ready]")
        return self.page

    def glass(self, **more: str) -> Page:
        """Load the page at the scene that departs."""
        state = {"scene": "bolha2", **more}
        return self.go("&".join(f"{key}={quote(value)}" for key, value in state.items()))

    def color(self, x: float, y: float) -> list[int]:
        """Return what the canvas shows at a place in CSS pixels."""
        found: list[int] = self.page.evaluate(
            "([x, y]) => { const v = ct.viewer.view; return [...v.context.getImageData("
            "Math.round(x * v.ratio), Math.round(y * v.ratio), 1, 1).data].slice(0, 3); }",
            [x, y],
        )
        return found

    def size(self) -> tuple[float, float]:
        """Return the size of the canvas in CSS pixels."""
        width, height = self.page.evaluate("[ct.viewer.view.width, ct.viewer.view.height]")
        return width, height

    def middle(self, row: int, col: int) -> tuple[float, float]:
        """Return where the middle of a pixel is on the canvas, where one image fills it."""
        x, y = self.page.evaluate(
            "([row, col]) => { const v = ct.viewer.view; return [v.width / 2 + (col + 0.5 - v.x)"
            " * v.zoom, v.height / 2 + (row + 0.5 - v.y) * v.zoom]; }",
            [row, col],
        )
        return x, y

    def pixel_at(self, x: float, y: float) -> tuple[int, int]:
        """Return (row, column) of the scene under a place of the canvas."""
        at = self.page.evaluate("([x, y]) => ct.viewer.view.pixelAt(x, y)", [x, y])
        return at["row"], at["col"]


@pytest.fixture
def opened(browser: Browser, folder: Path) -> Iterator[Opened]:
    """Give a page, which must not complain and must ask for nothing but its own file."""
    made = Opened(browser, folder)
    yield made
    made.context.close()
    assert made.complaints == []
    assert set(made.requests) <= {made.address, "about:blank"}


def entry(folder: Path, name: str = "bolha2") -> dict[str, Any]:
    report = json.loads((folder / "report.json").read_text(encoding="utf-8"))
    found: dict[str, Any] = next(scene for scene in report["scenes"] if scene["name"] == name)
    return found


def levels(folder: Path, lane: int, name: str = "bolha2") -> np.ndarray[Any, Any]:
    file = folder / entry(folder, name)["renderers"][lane]["images"]["png"]["file"]
    return np.rint(images.read(file) * 255).astype(int)


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


def test_every_picture_is_the_png_to_the_last_level(opened: Opened) -> None:
    """Packed as differences and unpacked by the browser, nothing is lost."""
    page = opened.glass()
    for lane in (0, 1):
        shown = page.evaluate(f"[...ct.viewer.scene.lanes[{lane}].levels]")
        assert np.array_equal(shown, levels(opened.folder, lane).ravel())


def test_the_slider_has_the_reference_on_its_left(opened: Opened) -> None:
    """And the chosen image on its right, wherever it stands."""
    page = opened.glass(mode="slider", image=PLAIN)
    page.evaluate("ct.viewer.cursor = null")
    native, plain = levels(opened.folder, 0), levels(opened.folder, 1)
    width, height = opened.size()
    for split in (20, 50, 80):
        page.locator("#split").fill(str(split))
        seen = {"left": 0, "right": 0}
        for at in np.linspace(0.1, 0.9, 25) * width:
            row, col = opened.pixel_at(at, 0.45 * height)
            x, y = opened.middle(row, col)
            if abs(x - split / 100 * width) < 5 or (native[row, col] == plain[row, col]).all():
                continue
            side = "left" if x < split / 100 * width else "right"
            seen[side] += 1
            expected = native if side == "left" else plain
            assert opened.color(x, y) == expected[row, col].tolist(), (split, side)
        assert min(seen.values()) >= 2


def test_images_side_by_side_share_one_zoom_and_place(opened: Opened) -> None:
    """After the wheel and a drag in one pane, the other shows the same part of its own image."""
    page = opened.glass(mode="beside", image=PLAIN)
    page.evaluate("ct.viewer.cursor = null")
    width, height = opened.size()
    box = page.locator("#view").bounding_box()
    assert box is not None
    before = page.evaluate("ct.viewer.view.zoom")
    page.mouse.move(box["x"] + 0.2 * width, box["y"] + 0.4 * height)
    page.mouse.wheel(0, -400)
    page.mouse.down()
    page.mouse.move(box["x"] + 0.25 * width, box["y"] + 0.5 * height, steps=4)
    page.mouse.up()
    assert page.evaluate("ct.viewer.view.zoom") > 1.5 * before
    lanes = [levels(opened.folder, lane) for lane in (0, 1)]
    for x, y in ((0.12, 0.3), (0.2, 0.6), (0.31, 0.5)):
        places = [(x * width, y * height), ((x + 0.5) * width, y * height)]
        at = [opened.pixel_at(*place) for place in places]
        assert at[0] == at[1]
        shown = [opened.color(*place) for place in places]
        assert shown == [lane[at[0]].tolist() for lane in lanes]


def test_the_inspector_shows_the_numbers_of_the_record(opened: Opened) -> None:
    """Values, classes, enclosure and rays are those of the files, to the last bit."""
    page = opened.glass()
    file = entry(opened.folder)["images"]["pixels"]["file"]
    pixels = json.loads((opened.folder / file).read_text(encoding="utf-8"))["pixels"]
    assert len(pixels) > 20
    page.locator("#view").focus()
    page.evaluate("ct.viewer.look(ct.viewer.scene.listed[0], true)")
    for pixel in pixels[:20]:
        title = page.locator("#inspector h3")
        assert int(title.get_attribute("data-row") or "") == pixel["row"]
        assert int(title.get_attribute("data-col") or "") == pixel["col"]
        for lane, known in pixel["lanes"].items():
            cells = page.locator(f'#inspector tr[data-value="{lane}"] td').all_inner_texts()
            assert [float(cell) for cell in cells] == known["value"]
            row = page.locator(f'#inspector tr[data-lane="{lane}"]').inner_text()
            assert known["class"] in row
        bounds = page.locator("#inspector tr.bound").first.locator("td").all_inner_texts()
        assert [float(cell) for cell in bounds] == pixel["enclosure"]["lo"]
        rays = page.locator("#inspector table.tree tbody tr").count()
        assert rays == len(pixel["tree"]["rays"])
        assert "null" not in page.locator("#inspector").inner_text()
        page.keyboard.press("n")


def test_the_worst_pixels_of_the_record_can_be_inspected(opened: Opened) -> None:
    """report.json names some; the page has their exact values, too."""
    page = opened.glass()
    (pair,) = entry(opened.folder)["pairs"]
    for worst in pair["worst"][:4]:
        at = f"{worst['row']},{worst['col']}"
        page.evaluate("(at) => { const [row, col] = at.split(',').map(Number);"
                      " ct.viewer.look({ row, col }, true); }", at)  # fmt: skip
        for lane, color in (("native", worst["a"]), (PLAIN, worst["b"])):
            cells = page.locator(f'#inspector tr[data-value="{lane}"] td').all_inner_texts()
            assert [float(cell) for cell in cells] == color


def test_the_line_to_paste_explains_the_same_pixel(opened: Opened) -> None:
    """Run as it stands, it gives the value that the inspector shows."""
    page = opened.glass()
    words = shlex.split(page.locator("#inspector code").inner_text())
    assert words[:2] == ["crosstrace", "explain"]
    told = call(*words[1:], "--renderers", "native", "--json")
    assert told.returncode == 0, told.stderr
    cells = page.locator('#inspector tr[data-value="native"] td').all_inner_texts()
    assert json.loads(told.stdout)["color"] == [float(cell) for cell in cells]


def test_zooming_by_key_keeps_the_pixel_in_view(opened: Opened) -> None:
    """Where it is near a corner, too; magnified, its colour fills its square."""
    page = opened.glass(image="native")
    lane = levels(opened.folder, 0)
    for row, col in ((0, 0), (ROWS - 1, COLUMNS - 1), (11, 4)):
        page.evaluate("([row, col]) => ct.viewer.look({ row, col }, true)", [row, col])
        page.locator("#view").focus()
        for _ in range(3):
            page.keyboard.press("+")
        zoom = page.evaluate("ct.viewer.view.zoom")
        assert zoom > 40
        x, y = opened.middle(row, col)
        width, height = opened.size()
        assert 0 < x < width and 0 < y < height
        for dx, dy in ((0, 0), (-0.45, 0.45), (0.45, -0.45)):
            assert opened.color(x + dx * zoom, y + dy * zoom) == lane[row, col].tolist()
        page.keyboard.press("0")


def test_a_pixel_without_exact_values_says_so(opened: Opened) -> None:
    """It still has its levels, its class and the line that gives the rest."""
    page = opened.go("scene=sky&pixel=3,5")
    text = page.locator("#inspector").inner_text()
    assert "Row 3, column 5" in text and "Exact values of this pixel are not in this page" in text
    assert "0 128 255" in text and "equal" in text


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


@pytest.mark.parametrize(
    "layer", ["difference", "absolute", "signed", "classes", "unlike", "digits"]
)
def test_every_layer_is_drawn_with_its_scale(opened: Opened, layer: str) -> None:
    """It shows something else than the picture, and its legend says what the colours mean."""
    page = opened.glass(image=PLAIN)
    x, y = (0.4 * side for side in opened.size())
    picture = opened.color(x, y)
    page.locator("#layer").select_option(layer)
    assert opened.color(x, y) != picture
    assert page.locator("#legend > span").count() >= 5
    page.reload()
    page.wait_for_selector("#viewer[data-ready]")
    assert page.locator("#layer").input_value() == layer


def test_signed_differences_have_their_sign_and_gain_is_written(opened: Opened) -> None:
    """Brighter than the reference is orange, darker is blue."""
    page = opened.glass(image=PLAIN, layer="signed")
    page.evaluate("ct.viewer.cursor = null")
    page.locator("#gain").fill("3")
    assert page.locator("#gain-value").inner_text() == "× 1000"
    lanes = entry(opened.folder)["renderers"]
    native, plain = (images.read(opened.folder / lane["images"]["exr"]["file"]) for lane in lanes)
    difference = plain - native
    signs = set()
    for row, col in np.ndindex(ROWS, COLUMNS):
        off = difference[row, col]
        most = off[np.abs(off).argmax()]
        # The EXR is float32: where channels are that near, it cannot say which is greatest.
        if (row + col) % 5 or abs(most) < 0.01 or (np.abs(off) > 0.999 * abs(most)).sum() > 1:
            continue
        red, _, blue = opened.color(*opened.middle(row, col))
        signs.add(bool(most > 0))
        assert (red > blue) == (most > 0), (row, col)
    assert signs == {True, False}


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
    browser: Browser, folder: Path, tmp_path: Path
) -> None:
    """A scene whose float128 value leaves its enclosure passes with none."""
    report = json.loads((folder / "report.json").read_text(encoding="utf-8"))
    for scene in report["scenes"]:
        if scene["name"] == "sky":
            scene |= {"verdict": "reference-broken", "blame": ["native"]}
            scene["judgement"]["truth"]["float128_outside"] = 1
    (tmp_path / "report.html").write_text(draw.page(report, folder), encoding="utf-8")
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


def test_no_other_script_runs(browser: Browser, folder: Path) -> None:
    """The page's policy knows its own script by its hash."""
    made = Opened(browser, folder)
    page = made.go()
    page.evaluate("const s = document.createElement('script'); s.textContent = 'window.broken = 1';"
                  " document.body.append(s)")  # fmt: skip
    assert page.evaluate("window.broken") is None
    assert any("Content Security Policy" in text for text in made.complaints)
    made.context.close()


def test_without_a_script_all_is_there_but_the_viewer(browser: Browser, folder: Path) -> None:
    """Verdicts, numbers and plots are plain HTML."""
    context = browser.new_context(java_script_enabled=False, offline=True)
    page = context.new_page()
    page.goto((folder / "report.html").as_uri())
    assert page.locator("section.scene:visible").count() == 3
    assert page.locator("svg.plot:visible").count() >= 2
    assert not page.locator("#viewer").is_visible()
    context.close()


@pytest.mark.parametrize(("width", "scheme"), [(400, "light"), (800, "dark"), (1900, "dark")])
def test_nothing_sticks_out_of_the_window(
    browser: Browser, folder: Path, width: int, scheme: Any
) -> None:
    """Wide tables scroll by themselves; the page does not."""
    made = Opened(browser, folder)
    made.page.set_viewport_size({"width": width, "height": 900})
    made.page.emulate_media(color_scheme=scheme)
    for hash_ in ("", "scene=bolha2"):
        page = made.go(hash_)
        assert page.evaluate("document.documentElement.scrollWidth") <= width
    made.context.close()
