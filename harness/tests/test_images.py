"""Image files: what each format keeps, which traps are avoided, and that no half file is left."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import OpenImageIO
import pytest

from crosstrace.harness import images
from crosstrace.harness.display import to_8bit
from crosstrace.translators.errors import UsageError

F32 = (".exr", ".pfm")
F64 = (".npy", ".npz")
EIGHT_BIT = (".png", ".ppm")


@pytest.fixture
def image() -> np.ndarray:
    """Return colours beyond 1, below 0 and of many magnitudes; no two pixels are alike."""
    rng = np.random.default_rng(11)
    made = rng.normal(0.5, 1.0, (7, 5, 3)) * 10.0 ** rng.integers(-6, 4, (7, 5, 3))
    made[0, 0] = 0.1, 1 / 3, 2.5
    return made


@pytest.mark.parametrize("suffix", F64)
def test_float64_formats_lose_nothing(tmp_path: Path, image: np.ndarray, suffix: str) -> None:
    """Every bit comes back."""
    images.write(tmp_path / f"x{suffix}", image)
    assert np.array_equal(images.read(tmp_path / f"x{suffix}"), image)


@pytest.mark.parametrize("suffix", F32)
def test_float32_formats_keep_float32(tmp_path: Path, image: np.ndarray, suffix: str) -> None:
    """Not half, not clipped, not upside down, the channels in their order."""
    images.write(tmp_path / f"x{suffix}", image)
    assert np.array_equal(images.read(tmp_path / f"x{suffix}"), image.astype(np.float32))


@pytest.mark.parametrize("suffix", EIGHT_BIT)
def test_8_bit_formats_hold_the_display_rule(
    tmp_path: Path, image: np.ndarray, suffix: str
) -> None:
    """Levels come back as fractions of 255, without a transfer curve."""
    images.write(tmp_path / f"x{suffix}", image)
    assert np.array_equal(images.read(tmp_path / f"x{suffix}"), to_8bit(image) / 255)


def test_a_portable_float_map_is_stored_from_the_bottom_row_up(tmp_path: Path) -> None:
    """As the format says, and as other programs read it."""
    image = np.zeros((2, 1, 3))
    image[0] = 1.0, 2.0, 3.0
    images.write(tmp_path / "x.pfm", image)
    data = (tmp_path / "x.pfm").read_bytes()
    assert data.startswith(b"PF\n1 2\n-1")
    assert np.frombuffer(data[-24:], "<f4").tolist() == [0, 0, 0, 1, 2, 3]


def test_a_big_endian_grey_float_map_of_another_program_is_read(tmp_path: Path) -> None:
    """The sign of the scale is the byte order."""
    pixels = np.array([[1.0, 2.0], [3.0, 4.0]], ">f4")
    (tmp_path / "x.pfm").write_bytes(b"Pf\n2 2\n1.0\n" + pixels.tobytes())
    assert images.read(tmp_path / "x.pfm")[..., 1].tolist() == [[3.0, 4.0], [1.0, 2.0]]


def test_exr_channels_are_found_by_name_whatever_their_order(tmp_path: Path) -> None:
    """Files sort them; other programs add more."""
    spec = OpenImageIO.ImageSpec(1, 1, 5, OpenImageIO.FLOAT)
    spec.channelnames = ("Z", "B", "G", "R", "A")
    file = OpenImageIO.ImageOutput.create("x.exr")
    assert file.open(str(tmp_path / "x.exr"), spec)
    assert file.write_image(np.array([[[9, 3, 2, 1, 0.5]]], np.float32))
    assert file.close()
    assert images.read(tmp_path / "x.exr")[0, 0].tolist() == [1.0, 2.0, 3.0]


def test_a_png_with_alpha_is_not_multiplied_by_it(tmp_path: Path) -> None:
    """The colour is what the file states."""
    spec = OpenImageIO.ImageSpec(1, 1, 4, OpenImageIO.UINT8)
    spec.attribute("oiio:UnassociatedAlpha", 1)
    file = OpenImageIO.ImageOutput.create("x.png")
    assert file.open(str(tmp_path / "x.png"), spec)
    assert file.write_image(np.array([[[200, 100, 51, 128]]], np.uint8))
    assert file.close()
    assert np.array_equal(images.read(tmp_path / "x.png")[0, 0] * 255, [200, 100, 51])


def test_16_bit_files_are_read_at_their_own_depth(tmp_path: Path) -> None:
    """Values are divided by 65535."""
    (tmp_path / "x.ppm").write_bytes(
        b"P6\n1 1\n65535\n" + np.array([1, 256, 65535], ">u2").tobytes()
    )
    assert np.array_equal(images.read(tmp_path / "x.ppm")[0, 0] * 65535, [1, 256, 65535])


@pytest.mark.parametrize("suffix", [".exr", ".png", ".npz"])
def test_metadata_comes_back(tmp_path: Path, image: np.ndarray, suffix: str) -> None:
    """An image says from what scene and by whom it was made."""
    path = tmp_path / f"x{suffix}"
    images.write(path, image, metadata={"scene_sha256": "ab" * 32, "settings": '{"a": "é"}'})
    metadata = images.read_with_metadata(path)[1]
    assert metadata["crosstrace:scene_sha256"] == "ab" * 32
    assert metadata["crosstrace:settings"] == '{"a": "é"}'


def test_side_outputs_go_beside_the_image_in_an_npz_only(tmp_path: Path, image: np.ndarray) -> None:
    """Elsewhere they are refused, not dropped."""
    layers: dict[str, np.ndarray] = {
        "object": np.zeros((7, 5), np.int32),
        "tree": np.ones((7, 5), np.uint64),
    }
    images.write(tmp_path / "x.npz", image, layers=layers)
    with np.load(tmp_path / "x.npz", allow_pickle=False) as stored:
        assert stored["object"].dtype == np.int32
        assert stored["tree"].dtype == np.uint64
    with pytest.raises(UsageError, match=r"\.npz"):
        images.write(tmp_path / "x.exr", image, layers=layers)


@pytest.mark.parametrize("name", ["x", "x.jpg", "x.exr.gz"])
def test_an_unknown_suffix_is_refused_by_name(tmp_path: Path, image: np.ndarray, name: str) -> None:
    """The message lists what there is."""
    with pytest.raises(UsageError, match=r"expected a file name ending in \.npy.*found"):
        images.write(tmp_path / name, image)


@pytest.mark.parametrize("suffix", images.SUFFIXES)
@pytest.mark.parametrize(
    "content", [b"", b"not an image\n", b"\x89PNG\r\n\x1a\n\0\0", b"PF\n9 9\n-1\n"]
)
def test_what_is_no_image_is_refused(tmp_path: Path, suffix: str, content: bytes) -> None:
    """With an error for the user, whatever library finds it."""
    path = tmp_path / f"x{suffix}"
    path.write_bytes(content)
    with pytest.raises(UsageError, match="x"):
        images.read(path)


@pytest.mark.parametrize("suffix", images.SUFFIXES)
def test_a_file_cut_short_is_refused(tmp_path: Path, image: np.ndarray, suffix: str) -> None:
    """Half an image is no image."""
    path = tmp_path / f"x{suffix}"
    images.write(path, np.tile(image, (20, 20, 1)))
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])
    with pytest.raises(UsageError):
        images.read(path)


def test_a_missing_file_and_arrays_of_another_kind_are_refused(tmp_path: Path) -> None:
    """Integers would be read on an unknown scale."""
    with pytest.raises(UsageError, match="found none"):
        images.read(tmp_path / "x.exr")
    for array in (np.zeros((2, 2)), np.zeros((2, 2, 4)), np.zeros((2, 2, 3), np.uint8)):
        np.save(tmp_path / "x.npy", array)
        with pytest.raises(UsageError, match="expected floats of shape"):
            images.read(tmp_path / "x.npy")


def test_an_array_that_would_run_code_is_refused(tmp_path: Path) -> None:
    """Pickled objects in a stranger's file are not loaded."""
    np.save(tmp_path / "x.npy", np.array([object()], dtype=object), allow_pickle=True)
    with pytest.raises(UsageError):
        images.read(tmp_path / "x.npy")


@pytest.mark.parametrize("suffix", images.SUFFIXES)
def test_writing_into_a_missing_directory_leaves_nothing(
    tmp_path: Path, image: np.ndarray, suffix: str
) -> None:
    """The error names the file."""
    with pytest.raises(UsageError, match="cannot be written"):
        images.write(tmp_path / "none" / f"x{suffix}", image)
    assert list(tmp_path.iterdir()) == []


def test_a_failed_write_keeps_the_old_file(tmp_path: Path) -> None:
    """The new one takes its place only when it is whole."""
    path = tmp_path / "x.npy"
    path.write_bytes(b"old")

    def fill(temporary: Path) -> None:
        temporary.write_bytes(b"half")
        raise OSError(28, "No space left on device")

    with pytest.raises(UsageError, match="No space left"):
        images.write_atomically(path, fill)
    assert [(p.name, p.read_bytes()) for p in tmp_path.iterdir()] == [("x.npy", b"old")]
