"""Fixtures of the POV-Ray tests: small scenes, the two renderers, stand-ins for the program."""

from __future__ import annotations

import shutil
import stat
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from official_scenes import official  # noqa: F401, pytest finds the fixture here

from crosstrace.translators.povray.adapter import PovRay
from crosstrace.translators.registry import renderer
from crosstrace.translators.renderer import Rendering, RenderOptions
from crosstrace.translators.scene import Scene


@pytest.fixture
def make_scene() -> Callable[..., Scene]:
    """Build a delivery-3 scene of 60×80 pixels; any field may be given."""

    def build(**fields: Any) -> Scene:
        camera: dict[str, Any] = {
            "delivery": 3, "v_res": 60, "h_res": 80, "pixel_size": 0.0125, "screen_distance": 1.0,
            "eye": [0.0, -4.0, 1.0], "target": [0.0, 0.0, 0.8], "up": [0.0, 0.0, 1.0],
            "background": [30.0, 40.0, 60.0], "max_depth": 4, "ambient": [200.0, 220.0, 255.0],
        }  # fmt: skip
        return Scene.build(**{**camera, **fields})

    return build


@pytest.fixture
def povray() -> PovRay:
    """The lane under test; the test is skipped where the program is not installed."""
    if shutil.which("povray") is None:
        pytest.skip("the program povray is not installed")
    return PovRay()


@pytest.fixture
def beyond(povray: PovRay) -> Callable[[Scene], tuple[int, Rendering]]:
    """Count the pixels where POV-Ray leaves native by more than 7.63e-6·K + 1e-5."""

    def count(scene: Scene) -> tuple[int, Rendering]:
        ours = renderer("native").render(scene, RenderOptions(threads=1)).image
        theirs = povray.render(scene, RenderOptions(threads=1, timeout_s=120))
        difference = np.abs(theirs.image - ours).max(axis=2)
        tolerance = 7.63e-6 * theirs.settings["output_scale"] + 1e-5
        return int((difference > tolerance).sum()), theirs

    return count


@pytest.fixture
def fake_povray(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[[str], Path]:
    """Put a shell script in the place of the program; its arguments are the program's."""

    def install(script: str) -> Path:
        program = tmp_path / "povray"
        program.write_text(f"#!/bin/sh\n{script}\n")
        program.chmod(program.stat().st_mode | stat.S_IXUSR)
        monkeypatch.setenv("CROSSTRACE_POVRAY", str(program))
        return program

    return install
