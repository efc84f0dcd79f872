"""Fixtures of the translators' tests: the oracle, and the course's official scenes if given."""

from __future__ import annotations

import importlib
import os
import sys
from pathlib import Path
from types import ModuleType

import pytest


@pytest.fixture(scope="session")
def oracle() -> ModuleType:
    """Import the slow numpy tracer that stands beside this file; it is no part of the package."""
    sys.path.insert(0, str(Path(__file__).parent))
    try:
        return importlib.import_module("oracle")
    finally:
        sys.path.pop(0)


@pytest.fixture(scope="session")
def official() -> Path:
    """Return the folder of the course's official scenes and images."""
    folder = os.environ.get("CROSSTRACE_COURSE")
    if not folder:
        pytest.skip("CROSSTRACE_COURSE does not name a folder of the course's official scenes")
    return Path(folder)
