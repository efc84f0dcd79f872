"""Image files by their suffix; writing never leaves half a file.

`.npy` and `.npz` hold float64 and lose nothing; `.exr` and `.pfm` hold float32; `.png` and `.ppm`
are 8-bit by the display rule (`display.py`). An `.npz` has the array `image` and any side outputs
beside it; only `.npz`, `.exr` and `.png` carry metadata.
"""

from __future__ import annotations

import hashlib
import json
import os
import zipfile
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crosstrace.harness.display import DisplayRule, to_8bit
from crosstrace.translators.errors import UsageError

Array = NDArray[np.float64]

SUFFIXES = (".npy", ".npz", ".exr", ".pfm", ".png", ".ppm")

#: Metadata keys of this package begin so.
PREFIX = "crosstrace:"


def suffix_of(path: str | os.PathLike[str]) -> str:
    """Return the suffix in lower case; raises UsageError for one that is not in `SUFFIXES`."""
    suffix = Path(path).suffix.lower()
    if suffix not in SUFFIXES:
        expected = ", ".join(SUFFIXES)
        raise UsageError(f"{path}: expected a file name ending in {expected}, found {suffix!r}")
    return suffix


def read(path: str | os.PathLike[str]) -> Array:
    """Read an image as linear (rows, columns, 3) float64, row 0 at the top.

    8-bit values v become v / 255. Raises UsageError for a missing, unreadable or unknown file.
    """
    return read_with_metadata(path)[0]


def read_with_metadata(path: str | os.PathLike[str]) -> tuple[Array, dict[str, str]]:
    """Read an image and its text metadata (empty where the format has none)."""
    file, suffix = Path(path), suffix_of(path)
    if not file.is_file():
        raise UsageError(f"{path}: expected an image file, found none")
    try:
        if suffix in (".npy", ".npz"):
            return _read_numpy(file)
        if suffix == ".pfm":
            from crosstrace.harness import pfm

            return pfm.read(file), {}
        from crosstrace.harness import oiio_files

        return oiio_files.read(file)
    except OSError as error:
        raise UsageError(f"{path}: cannot be read: {error.strerror}") from error


def write(
    path: str | os.PathLike[str],
    image: NDArray[np.floating[Any]],
    *,
    metadata: Mapping[str, str] | None = None,
    layers: Mapping[str, NDArray[Any]] | None = None,
    rule: DisplayRule | None = None,
) -> None:
    """Write a linear image (rows, columns, 3) in the format of the suffix, all of it or nothing.

    `layers` go into an `.npz` beside `image`; elsewhere they raise UsageError. `rule` is the
    display rule of the 8-bit formats.
    """
    suffix = suffix_of(path)
    if layers and suffix != ".npz":
        raise UsageError(f"{path}: expected a file name ending in .npz for the side outputs")
    with_prefix = {PREFIX + key: value for key, value in (metadata or {}).items()}
    if suffix == ".npy":
        write_atomically(path, lambda temporary: _save_npy(temporary, image))
    elif suffix == ".npz":
        arrays = {"image": np.asarray(image, np.float64), **(layers or {})}
        if with_prefix:
            arrays["metadata"] = np.array(json.dumps(with_prefix))
        write_atomically(path, lambda temporary: _save_npz(temporary, arrays))
    elif suffix == ".pfm":
        from crosstrace.harness import pfm

        write_atomically(path, lambda temporary: pfm.write(temporary, image))
    else:
        eight_bit = suffix in (".png", ".ppm")
        pixels = to_8bit(image, rule) if eight_bit else image.astype(np.float32)
        write_pixels(path, pixels, with_prefix)


def write_pixels(
    path: str | os.PathLike[str], pixels: NDArray[Any], metadata: Mapping[str, str] | None = None
) -> None:
    """Write ready pixels, uint8 for `.png` and `.ppm`, float32 for `.exr`."""
    from crosstrace.harness import oiio_files

    suffix = suffix_of(path)
    write_atomically(path, lambda temporary: oiio_files.write(temporary, pixels, suffix, metadata))


def write_atomically(path: str | os.PathLike[str], fill: Callable[[Path], None]) -> None:
    """Let `fill` write a temporary file beside `path`, then put it in the place of `path`.

    Raises UsageError where the place cannot be written; then nothing is left behind.
    """
    target = Path(path)
    temporary = target.with_name(f".{target.stem}.{os.getpid()}.partial{target.suffix}")
    try:
        fill(temporary)
        temporary.replace(target)
    except OSError as error:
        raise UsageError(f"{path}: cannot be written: {error.strerror or error}") from error
    finally:
        temporary.unlink(missing_ok=True)


def write_bytes(path: str | os.PathLike[str], content: bytes) -> None:
    """Write a file whole or not at all; raises as `write_atomically`."""

    def fill(temporary: Path) -> None:
        temporary.write_bytes(content)

    write_atomically(path, fill)


def write_arrays(path: str | os.PathLike[str], arrays: Mapping[str, NDArray[Any]]) -> None:
    """Write a compressed `.npz` whole or not at all; raises as `write_atomically`."""

    def fill(temporary: Path) -> None:
        with temporary.open("wb") as file:
            np.savez_compressed(file, allow_pickle=False, **arrays)

    write_atomically(path, fill)


def sha256(path: Path) -> str:
    """Return the SHA-256 of a file's bytes."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def _save_npy(path: Path, image: NDArray[Any]) -> None:
    with path.open("wb") as file:
        np.save(file, np.asarray(image, np.float64), allow_pickle=False)


def _save_npz(path: Path, arrays: Mapping[str, NDArray[Any]]) -> None:
    with path.open("wb") as file:
        np.savez(file, allow_pickle=False, **arrays)


def _read_numpy(path: Path) -> tuple[Array, dict[str, str]]:
    metadata: dict[str, str] = {}
    try:
        loaded = np.load(path, allow_pickle=False)
        if isinstance(loaded, np.ndarray):
            image = loaded
        else:
            with loaded:
                image = loaded["image"]
                if "metadata" in loaded:
                    metadata = json.loads(str(loaded["metadata"]))
    except (ValueError, KeyError, EOFError, zipfile.BadZipFile) as error:
        raise UsageError(f"{path}: expected an array `image`, found: {error}") from error
    if image.ndim != 3 or image.shape[2] != 3 or not np.issubdtype(image.dtype, np.floating):
        found = f"shape {image.shape} of {image.dtype}"
        raise UsageError(f"{path}: expected floats of shape (rows, columns, 3), found {found}")
    return np.ascontiguousarray(image, np.float64), metadata
