"""The output scale grows only where something saturates, and 16-bit files are read exactly."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from crosstrace.translators.errors import RendererError
from crosstrace.translators.povray.output import (
    Picture,
    read_ppm,
    render_scaled,
    safe_scale,
    shared,
)


class Program:
    """Quantises given values as POV-Ray does and remembers the scales asked for."""

    def __init__(self, values: list[float]) -> None:
        """Keep the pixels' values, a multiple of three."""
        self.values = np.array(values).reshape(1, -1, 3)
        self.scales: list[float] = []

    def __call__(self, scale: float) -> Picture:
        """Return the picture at one scale."""
        self.scales.append(scale)
        samples = np.floor(np.clip(self.values / scale, 0, 1) * 65535 + 0.5)
        return Picture(samples.astype(np.uint16), "3.7.0.10")


def test_one_pass_is_enough_where_the_scene_cannot_exceed_white() -> None:
    """With a bound of 1 a white pixel is no reason to render again."""
    program = Program([1.0, 0.5, 0.0])
    made = render_scaled(program, bound=1.0, background=1.0)
    assert program.scales == [1.0]
    assert made.image.ravel().tolist() == [1.0, 32768 / 65535, 0.0]


def test_only_saturated_samples_pay_for_a_larger_scale() -> None:
    """Samples that fit keep the step of the first pass."""
    program = Program([1.3, 0.1, 3.0])
    made = render_scaled(program, bound=20.0, background=0.0)
    assert program.scales == [1.0, 2.0, 8.0]
    errors = np.abs(made.image - program.values).ravel()
    assert (errors <= np.array([2, 1, 8]) / 131070).all()
    assert made.half_step == 8 / 131070


def test_the_bound_ends_the_growth() -> None:
    """No scale is larger than what the scene's bound calls for."""
    program = Program([2.9, 0.1, 0.2])
    assert render_scaled(program, bound=2.95, background=0.0).passes == (1.0, 2.0, 4.0)


def test_a_white_background_is_not_taken_for_saturation() -> None:
    """Where more than white is possible, exactly white stays told apart from it."""
    program = Program([1.0, 0.5, 1.0])
    made = render_scaled(program, bound=5.0, background=1.0)
    assert len(program.scales) == 1
    assert np.abs(made.image - program.values).max() <= made.half_step


@pytest.mark.parametrize(("bound", "scale"), [(0.0, 1.0), (1.0, 1.0), (1.01, 2.0), (4.0, 8.0)])
def test_the_safe_scale_leaves_room_for_float32(bound: float, scale: float) -> None:
    """A bound just at a power of two takes the next one."""
    assert safe_scale(bound) == scale


def test_a_ppm_is_read_to_the_last_bit(tmp_path: Path) -> None:
    """Samples are big-endian, rows from the top, and the header's comments name the version."""
    samples = np.arange(18, dtype=np.uint16).reshape(2, 3, 3) * 3000
    header = b"P6\n# Software: POV-Ray 3.7.0.10.unofficial\n#\n3 2\n65535\n"
    (tmp_path / "image.ppm").write_bytes(header + samples.astype(">u2").tobytes())
    picture = read_ppm(tmp_path / "image.ppm", 2, 3)
    assert (picture.samples == samples).all()
    assert picture.version == "3.7.0.10"


@pytest.mark.parametrize(
    ("raw", "message"),
    [
        (b"", "no PPM"),
        (b"P6\n3 2\n255\n" + bytes(18), "maximum 255"),
        (b"P6\n2 3\n65535\n" + bytes(36), "2×3"),
        (b"P6\n3 2\n65535\n" + bytes(35), "35 bytes of pixels, expected 36"),
    ],
)
def test_another_file_is_refused(tmp_path: Path, raw: bytes, message: str) -> None:
    """An empty, 8-bit, transposed or truncated file is no image."""
    (tmp_path / "image.ppm").write_bytes(raw)
    with pytest.raises(RendererError, match=message):
        read_ppm(tmp_path / "image.ppm", 2, 3)


def test_progress_never_runs_backwards() -> None:
    """Passes that may follow each other share the whole, a single pass takes all of it."""
    seen: list[float] = []
    for bound, passes, fractions in ((3.0, 0, (0.0, 1.0)), (3.0, 1, (0.0, 1.0))):
        part = shared(seen.append, bound, passes)
        assert part is not None
        for fraction in fractions:
            part(fraction)
    assert seen == [0.0, 0.5, 0.5, 0.75]
    assert shared(seen.append, 1.0, 0) == seen.append
    assert shared(None, 3.0, 0) is None
