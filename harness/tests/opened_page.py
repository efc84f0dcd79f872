"""A report page in a real browser: headless Chromium opens it from a file, the network off.

The scenes are small. Two lanes that differ everywhere stand side by side: the native tracer, and
one that paints the background alone, so that left and right can be told apart.
"""

from __future__ import annotations

import json
import os
import shutil
from pathlib import Path
from typing import Any
from urllib.parse import quote

import numpy as np
import pytest
from playwright.sync_api import Browser, ConsoleMessage, Page, Request
from small_runs import sky

from crosstrace.harness import images
from crosstrace.harness.session import RunOptions, run
from crosstrace.harness.sources import Source, find

PLAIN = "fake_lanes:Plain"
ROWS, COLUMNS = 24, 32
NASTY = "<img src=x onerror=document.title='broken'>&\"%s/../é</script>"
BROWSERS = ("chromium", "chromium-browser", "google-chrome")


def installed() -> str:
    """Return the browser; without one the test is skipped, except where one is required."""
    found = next(filter(None, map(shutil.which, BROWSERS)), None)
    if found is None:
        message = f"no browser: none of {', '.join(BROWSERS)} is installed"
        if os.environ.get("CROSSTRACE_REQUIRE_BROWSER"):
            pytest.fail(message)
        pytest.skip(message)
    return found


def make_report(out: Path) -> None:
    """Leave a report on a scene that departs and two that agree."""
    sources = [Source("sky", sky()), Source(NASTY, sky(), title=NASTY), *find(["bolha2"])]
    run(sources, out, RunOptions(("native", PLAIN), jobs=2, timeout_s=60, size=(ROWS, COLUMNS)))


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


def entry(folder: Path, name: str = "bolha2") -> dict[str, Any]:
    report = json.loads((folder / "report.json").read_text(encoding="utf-8"))
    found: dict[str, Any] = next(scene for scene in report["scenes"] if scene["name"] == name)
    return found


def levels(folder: Path, lane: int, name: str = "bolha2") -> np.ndarray[Any, Any]:
    file = folder / entry(folder, name)["renderers"][lane]["images"]["png"]["file"]
    return np.rint(images.read(file) * 255).astype(int)
