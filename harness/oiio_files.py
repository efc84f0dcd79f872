"""OpenEXR, PNG and PPM files through OpenImageIO, whose traps are handled here and nowhere else.

OpenEXR holds float32 at most: the library takes `double` without a word and stores float32, so
float32 is asked for. Channels come back sorted by name: they are addressed by name. An image with
alpha comes premultiplied unless told otherwise. Its size limit is tens of gigabytes until lowered.
"""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crosstrace.translators.errors import UsageError

#: A stranger's image beyond this is refused before its pixels are read: 8k × 8k float32 RGBA.
LARGEST_MB = 1024
#: The same for one that is read by rows, of which never many are held.
LARGEST_READ_BY_ROWS_MB = 64 * 1024

_WRITE_ATTRIBUTES: dict[str, dict[str, str | int]] = {
    ".exr": {"compression": "zip"},
    # Level 2 is three times as fast as the default and a quarter larger.
    ".png": {"png:compressionLevel": 2},
    ".ppm": {"pnm:binary": 1},
}


def _library(largest_mb: int = LARGEST_MB) -> Any:
    import OpenImageIO

    OpenImageIO.attribute("limits:imagesize_MB", largest_mb)
    OpenImageIO.attribute("limits:channels", 64)
    return OpenImageIO


@contextlib.contextmanager
def reading(path: Path, largest_mb: int = LARGEST_READ_BY_ROWS_MB) -> Iterator[Any]:
    """Open an image; gives its shape, what reads rows [begin, end), and its text metadata.

    Rows are (count, columns, 3) float64. 8- and 16-bit values are divided by their greatest, 255 or
    65535; nothing else is converted, and no transfer curve is undone. Raises UsageError for what
    cannot be read.
    """
    oiio = _library(largest_mb)
    config = oiio.ImageSpec()
    config.attribute("oiio:UnassociatedAlpha", 1)
    source = oiio.ImageInput.open(str(path), config)
    if source is None:
        raise UsageError(f"{path}: expected an image, found: {_reason(oiio, path)}")
    try:
        spec = source.spec()
        names = [name.rpartition(".")[2] for name in spec.channelnames]
        top, columns, channels = spec.y, spec.width, spec.nchannels

        def read_rows(begin: int, end: int) -> NDArray[np.float64]:
            pixels = source.read_scanlines(top + begin, top + end, 0, 0, channels, oiio.UNKNOWN)
            if pixels is None:
                raise UsageError(f"{path}: expected a whole image, found: {source.geterror()}")
            pixels = np.asarray(pixels).reshape(end - begin, columns, channels)
            return _three_channels(_as_float(pixels), names)

        metadata = {a.name: str(a.value) for a in spec.extra_attribs if isinstance(a.value, str)}
        yield (spec.height, columns, 3), read_rows, metadata
    finally:
        source.close()


def read(path: Path) -> tuple[NDArray[np.float64], dict[str, str]]:
    """Read an image as (rows, columns, 3) float64, and its text metadata; see `reading`."""
    with reading(path, LARGEST_MB) as (shape, read_rows, metadata):
        return read_rows(0, shape[0]), metadata


@contextlib.contextmanager
def writing(
    path: Path, shape: tuple[int, ...], suffix: str, metadata: Mapping[str, str] | None = None
) -> Iterator[Callable[[NDArray[Any]], None]]:
    """Open a file for float32 rows (`.exr`) or uint8 ones (`.png`, `.ppm`), given from the top.

    Raises UsageError.
    """
    oiio = _library()
    rows, columns, channels = shape
    spec = oiio.ImageSpec(columns, rows, channels, oiio.FLOAT if suffix == ".exr" else oiio.UINT8)
    for name, value in (*_WRITE_ATTRIBUTES[suffix].items(), *(metadata or {}).items()):
        spec.attribute(name, value)
    target = oiio.ImageOutput.create(str(path))
    if target is None or not target.open(str(path), spec):
        raise UsageError(f"{path}: cannot be written: {_reason(oiio, path, target)}")
    row = 0

    def write_rows(pixels: NDArray[Any]) -> None:
        nonlocal row
        begin, row = row, row + len(pixels)
        if not target.write_scanlines(begin, row, 0, np.ascontiguousarray(pixels)):
            raise UsageError(f"{path}: cannot be written: {target.geterror()}")

    try:
        yield write_rows
    except BaseException:
        target.close()
        raise
    if not target.close():
        raise UsageError(f"{path}: cannot be written: {target.geterror()}")


def write(
    path: Path, image: NDArray[Any], suffix: str, metadata: Mapping[str, str] | None = None
) -> None:
    """Write float32 pixels to `.exr`, uint8 ones to `.png` or `.ppm`; raises UsageError."""
    with writing(path, image.shape, suffix, metadata) as write_rows:
        write_rows(image)


def _reason(oiio: Any, path: Path, target: Any = None) -> str:
    reason = (target.geterror() if target is not None else "") or oiio.geterror() or "no reason"
    return str(reason).strip().replace(f'"{path}"', "it")


def _as_float(pixels: NDArray[Any]) -> NDArray[np.float64]:
    if np.issubdtype(pixels.dtype, np.integer):
        return pixels / float(np.iinfo(pixels.dtype).max)
    return pixels.astype(np.float64)


def _three_channels(pixels: NDArray[np.float64], names: list[str]) -> NDArray[np.float64]:
    upper = [name.upper() for name in names]
    if all(letter in upper for letter in "RGB"):
        return np.ascontiguousarray(pixels[..., [upper.index(letter) for letter in "RGB"]])
    if len(names) >= 3:
        return np.ascontiguousarray(pixels[..., :3])
    return np.repeat(pixels[..., :1], 3, axis=2)
