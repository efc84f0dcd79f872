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
    written_scale,
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
    made = render_scaled(program, bound=1.0)
    assert program.scales == [1.0]
    assert made.image.ravel().tolist() == [1.0, 32768 / 65535, 0.0]


@pytest.mark.parametrize(("bound", "scale"), [(1.5, 1.51), (1.9, 1.91), (20.0, 2.0)])
def test_one_pass_is_enough_for_values_up_to_two(bound: float, scale: float) -> None:
    """The first scale is the scene's bound, and 2 where that is larger."""
    program = Program([1.45, 0.1, 1.2])
    made = render_scaled(program, bound=bound)
    assert made.passes == (scale,)
    assert np.abs(made.image - program.values).max() <= made.half_step


def test_only_saturated_samples_pay_for_a_larger_scale() -> None:
    """Samples that fit keep the step of the first pass."""
    program = Program([1.3, 3.0, 12.0])
    made = render_scaled(program, bound=99.0)
    assert program.scales == [2.0, 8.0, 32.0]
    errors = np.abs(made.image - program.values).ravel()
    assert (errors <= np.array([2, 8, 32]) / 131070).all()
    assert made.half_step == 32 / 131070


def test_the_bound_ends_the_growth() -> None:
    """No scale is larger than what the scene's bound calls for."""
    program = Program([2.9, 0.1, 0.2])
    assert render_scaled(program, bound=2.95).passes == (2.0, 2.96)


def test_a_white_background_is_not_taken_for_saturation() -> None:
    """Where more than white is possible, exactly white stays told apart from it."""
    program = Program([1.0, 0.5, 1.0])
    made = render_scaled(program, bound=5.0)
    assert len(program.scales) == 1
    assert np.abs(made.image - program.values).max() <= made.half_step


@pytest.mark.parametrize("bound", [1.01, 2.0, 300.0])
def test_the_safe_scale_leaves_room_for_float32(bound: float) -> None:
    """A value at the bound, rounded upwards, is still told apart from a saturated one."""
    assert np.float32(bound) * np.float32(1 + 1e-6) < safe_scale(bound) < bound * 1.011


@pytest.mark.parametrize("bound", [1.0000001, 1.2345678, 13.000013, 987654.3, 1.5e9])
def test_scales_have_few_digits(bound: float) -> None:
    """POV-Ray keeps six digits of a declared number; what it would cut shifted bright images."""
    program = Program([0.9 * bound] * 3)
    for scale in (*render_scaled(program, bound).passes, safe_scale(bound)):
        assert float(f"{scale:.6g}") == scale


def test_a_scene_that_cannot_exceed_white_needs_no_scale() -> None:
    """Below 1 the scale stays 1, so that flat colours keep their exact samples."""
    assert (safe_scale(0.0), safe_scale(1.0)) == (1.0, 1.0)


def test_a_written_scene_keeps_a_usable_precision() -> None:
    """A bound that counts hundreds of bounces does not darken the whole image to nothing."""
    assert written_scale(4.0) == safe_scale(4.0)
    assert written_scale(1e9) == 16.0


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
