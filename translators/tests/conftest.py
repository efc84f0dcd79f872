"""Fixtures of the translators' tests: the oracle, and the course's official scenes if given."""

from __future__ import annotations

import importlib
import os
import sys
from collections.abc import Callable
from pathlib import Path
from types import ModuleType

import pytest

from crosstrace.translators.scene import Scene


def _beside(name: str) -> ModuleType:
    sys.path.insert(0, str(Path(__file__).parent))
    try:
        return importlib.import_module(name)
    finally:
        sys.path.pop(0)


@pytest.fixture(scope="session")
def oracle() -> ModuleType:
    """Import the slow numpy tracer that stands beside this file; it is no part of the package."""
    return _beside("oracle")


@pytest.fixture(scope="session")
def random_scene() -> Callable[..., Scene]:
    """Return the generator of small random scenes."""
    make: Callable[..., Scene] = _beside("random_scenes").random_scene
    return make


@pytest.fixture(scope="session")
def official() -> Path:
    """Return the folder of the course's official scenes and images."""
    folder = os.environ.get("CROSSTRACE_COURSE")
    if not folder:
        pytest.skip("CROSSTRACE_COURSE does not name a folder of the course's official scenes")
    return Path(folder)
