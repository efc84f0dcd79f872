"""What the tests of all parts share: the course's official scenes, if they are at hand.

Every conftest.py that needs the fixture imports it.
"""

from __future__ import annotations

import os
from pathlib import Path

import pytest


@pytest.fixture(scope="session")
def official() -> Path:
    """Return the folder of the course's official scenes and images."""
    folder = os.environ.get("CROSSTRACE_COURSE")
    if not folder:
        pytest.skip("CROSSTRACE_COURSE does not name a folder of the course's official scenes")
    return Path(folder)
