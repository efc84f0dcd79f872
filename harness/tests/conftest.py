"""Fixtures of the harness's tests; the helper modules beside this file reach worker processes."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from crosstrace.harness.jobs import WorkerPool
from crosstrace.translators.scene import Scene

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
