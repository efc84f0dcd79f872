"""Image files row by row, for images that nobody should hold whole; formats as in `images.py`.

What is written here is byte for byte what `images.write` writes of the same image and metadata, and
what is read the same numbers.
"""

from __future__ import annotations

import contextlib
import json
import os
import zipfile
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import IO, Any

import numpy as np
from numpy.typing import NDArray

from crosstrace.harness import pfm
from crosstrace.harness.display import DisplayRule, to_8bit
from crosstrace.harness.images import PREFIX, suffix_of
from crosstrace.translators.errors import UsageError

Array = NDArray[np.float64]

#: Takes the next rows, (count, columns, 3) float64.
Write = Callable[[Array], None]


class RowsOfFile:
    """An image file as `bands.Rows`."""

    def __init__(
        self, shape: tuple[int, int, int], read: Callable[[int, int], Array],
        metadata: Mapping[str, str],
    ) -> None:  # fmt: skip
        """Take what reads rows [begin, end), always the ones that follow the last."""
        self.shape, self.metadata = shape, metadata
        self._read, self._row = read, 0

    def next(self, count: int) -> Array:
        """Return the next rows."""
        begin, self._row = self._row, self._row + count
        return self._read(begin, self._row)


@contextlib.contextmanager
def reading(path: str | os.PathLike[str]) -> Iterator[RowsOfFile]:
    """Open an image file; raises UsageError for a missing, unreadable or unknown one."""
    file, suffix = Path(path), suffix_of(path)
    if not file.is_file():
        raise UsageError(f"{path}: expected an image file, found none")
    readers = {".npy": _reading_npy, ".npz": _reading_npz, ".pfm": pfm.reading}
    try:
        if suffix in readers:
            with readers[suffix](file) as found:
                yield RowsOfFile(*found)
            return
        from crosstrace.harness import oiio_files

        with oiio_files.reading(file) as found:
            yield RowsOfFile(*found)
    except OSError as error:
        raise UsageError(f"{path}: cannot be read: {error.strerror}") from error
    except (ValueError, KeyError, EOFError, zipfile.BadZipFile) as error:
        raise UsageError(f"{path}: expected an array `image`, found: {error}") from error


@contextlib.contextmanager
def writing(
    path: Path,
    shape: tuple[int, int, int],
    metadata: Mapping[str, str],
    rule: DisplayRule | None = None,
    guard: float | None = None,
) -> Iterator[Write]:
    """Open a file for an image of that shape; the rows are then given from the top.

    `path` is written as the rows come: give a temporary name. `guard` is that of `to_8bit`, which
    cannot tell from a few rows what arithmetic they come from.
    """
    suffix = suffix_of(path)
    with_prefix = {PREFIX + key: value for key, value in metadata.items()}
    if suffix == ".npy":
        with path.open("wb") as file:
            _write_header(file, shape)
            yield lambda rows: _append(file, rows)
    elif suffix == ".npz":
        with zipfile.ZipFile(path, "w", zipfile.ZIP_STORED, allowZip64=True) as archive:
            with archive.open("image.npy", "w", force_zip64=True) as member:
                _write_header(member, shape)
                yield lambda rows: _append(member, rows)
            if with_prefix:
                with archive.open("metadata.npy", "w", force_zip64=True) as member:
                    np.lib.format.write_array(member, np.array(json.dumps(with_prefix)))
    elif suffix == ".pfm":
        with pfm.writing(path, shape) as write:
            yield write
    else:
        from crosstrace.harness import oiio_files

        eight_bit = suffix in (".png", ".ppm")
        with oiio_files.writing(path, shape, suffix, with_prefix) as write_pixels:
            if eight_bit:
                yield lambda rows: write_pixels(to_8bit(rows, rule, guard))
            else:
                yield lambda rows: write_pixels(rows.astype(np.float32))


def _write_header(file: IO[bytes], shape: tuple[int, int, int]) -> None:
    header = {"descr": "<f8", "fortran_order": False, "shape": shape}
    np.lib.format.write_array_header_1_0(file, header)


def _append(file: IO[bytes], rows: Array) -> None:
    file.write(np.ascontiguousarray(rows, "<f8").data.cast("B"))


@contextlib.contextmanager
def _reading_npy(path: Path) -> Iterator[Any]:
    with path.open("rb") as file:
        yield _rows_of_array(file, path, {})


@contextlib.contextmanager
def _reading_npz(path: Path) -> Iterator[Any]:
    with zipfile.ZipFile(path) as archive:
        metadata: dict[str, str] = {}
        if "metadata.npy" in archive.namelist():
            with archive.open("metadata.npy") as member:
                array = np.lib.format.read_array(member, allow_pickle=False)
            metadata = json.loads(str(array))
        with archive.open("image.npy") as member:
            yield _rows_of_array(member, path, metadata)


def _rows_of_array(file: IO[bytes], path: Path, metadata: Mapping[str, str]) -> Any:
    shape, is_fortran, dtype = _read_header(file)
    if len(shape) != 3 or shape[2] != 3 or not np.issubdtype(dtype, np.floating):
        found = f"shape {shape} of {dtype}"
        raise UsageError(f"{path}: expected floats of shape (rows, columns, 3), found {found}")
    if is_fortran:
        raise UsageError(f"{path}: expected an array in C order, found one in Fortran's")
    row = shape[1] * 3

    def read(begin: int, end: int) -> Array:
        count = (end - begin) * row
        data = file.read(count * dtype.itemsize)
        if len(data) < count * dtype.itemsize:
            raise UsageError(f"{path}: expected {shape[0]} rows, found fewer")
        return np.frombuffer(data, dtype).reshape(-1, shape[1], 3).astype(np.float64, copy=False)

    return shape, read, metadata


def _read_header(file: IO[bytes]) -> tuple[Any, bool, np.dtype[Any]]:
    version = np.lib.format.read_magic(file)
    if version == (1, 0):
        return np.lib.format.read_array_header_1_0(file)
    return np.lib.format.read_array_header_2_0(file)
