"""Fixtures of the harness's tests; the helper modules beside this file reach worker processes."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from official_scenes import official  # noqa: F401, pytest finds the fixture here

from crosstrace.harness.jobs import WorkerPool
from crosstrace.translators.scene import Scene

if TYPE_CHECKING:
    from opened_page import Opened
    from playwright.sync_api import Browser

# Workers look for modules where their owner does.
sys.path.insert(0, str(Path(__file__).parent))


@pytest.fixture
def pool() -> Iterator[WorkerPool]:
    """Give a pool of one worker at a time."""
    with WorkerPool(1) as made:
        yield made


@pytest.fixture
def scene() -> Scene:
    """Give the smallest scene whose images have an SSIM."""
    from small_runs import sky

    return sky()


@pytest.fixture(scope="session")
def report_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Give the directory of a report on a scene that departs and two that agree."""
    from opened_page import make_report

    out = tmp_path_factory.mktemp("browser") / "out"
    make_report(out)
    return out


@pytest.fixture(scope="session")
def browser() -> Iterator[Browser]:
    """Give a browser; without one the tests are skipped, except where one is required."""
    from opened_page import installed
    from playwright.sync_api import sync_playwright

    found = installed()
    with sync_playwright() as playwright:
        made = playwright.chromium.launch(executable_path=found)
        yield made
        made.close()


@pytest.fixture
def opened(browser: Browser, report_folder: Path) -> Iterator[Opened]:
    """Give a page, which must not complain and must ask for nothing but its own file."""
    from opened_page import Opened

    made = Opened(browser, report_folder)
    yield made
    made.context.close()
    assert made.complaints == []
    assert set(made.requests) <= {made.address, "about:blank"}
