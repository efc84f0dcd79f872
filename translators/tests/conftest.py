"""Fixtures of the translators' tests: the oracle and random scenes."""

from __future__ import annotations

import importlib
import sys
from collections.abc import Callable
from pathlib import Path
from types import ModuleType

import pytest
from official_scenes import official  # noqa: F401, pytest finds the fixture here

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
