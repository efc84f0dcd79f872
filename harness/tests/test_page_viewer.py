"""A scene's viewer and inspector, in a real browser: what they show is what the record says."""

from __future__ import annotations

import json
import shlex

import numpy as np
import pytest
from command_line import call
from opened_page import COLUMNS, PLAIN, ROWS, Opened, entry, levels

from crosstrace.harness import images


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
