"""OpenEXR, PNG and PPM files through OpenImageIO, whose traps are handled here and nowhere else.

OpenEXR holds float32 at most: the library takes `double` without a word and stores float32, so
float32 is asked for. Channels come back sorted by name: they are addressed by name. An image with
alpha comes premultiplied unless told otherwise. Its size limit is tens of gigabytes until lowered.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crosstrace.translators.errors import UsageError

#: A stranger's image beyond this is refused before its pixels are read: 8k × 8k float32 RGBA.
LARGEST_MB = 1024

_WRITE_ATTRIBUTES: dict[str, dict[str, str | int]] = {
    ".exr": {"compression": "zip"},
    # Level 2 is three times as fast as the default and a quarter larger.
    ".png": {"png:compressionLevel": 2},
    ".ppm": {"pnm:binary": 1},
}


def _library() -> Any:
    import OpenImageIO

    OpenImageIO.attribute("limits:imagesize_MB", LARGEST_MB)
    OpenImageIO.attribute("limits:channels", 64)
    return OpenImageIO


def read(path: Path) -> tuple[NDArray[np.float64], dict[str, str]]:
    """Read an image as (rows, columns, 3) float64, and its text metadata.

    8- and 16-bit values are divided by their greatest, 255 or 65535; nothing else is converted, and
    no transfer curve is undone. Raises UsageError for what cannot be read.
    """
    oiio = _library()
    config = oiio.ImageSpec()
    config.attribute("oiio:UnassociatedAlpha", 1)
    source = oiio.ImageInput.open(str(path), config)
    if source is None:
        raise UsageError(f"{path}: expected an image, found: {_reason(oiio, path)}")
    try:
        spec = source.spec()
        pixels = source.read_image(oiio.UNKNOWN)
        if pixels is None:
            raise UsageError(f"{path}: expected a whole image, found: {source.geterror()}")
        names = [name.rpartition(".")[2] for name in spec.channelnames]
    finally:
        source.close()
    pixels = np.asarray(pixels).reshape(spec.height, spec.width, spec.nchannels)
    metadata = {a.name: str(a.value) for a in spec.extra_attribs if isinstance(a.value, str)}
    return _three_channels(_as_float(pixels), names), metadata


def write(
    path: Path, image: NDArray[Any], suffix: str, metadata: Mapping[str, str] | None = None
) -> None:
    """Write float32 pixels to `.exr`, uint8 ones to `.png` or `.ppm`; raises UsageError."""
    oiio = _library()
    pixels = np.ascontiguousarray(image)
    rows, columns, channels = pixels.shape
    kind = oiio.FLOAT if pixels.dtype == np.float32 else oiio.UINT8
    spec = oiio.ImageSpec(columns, rows, channels, kind)
    for name, value in (*_WRITE_ATTRIBUTES[suffix].items(), *(metadata or {}).items()):
        spec.attribute(name, value)
    target = oiio.ImageOutput.create(str(path))
    if target is None or not target.open(str(path), spec):
        raise UsageError(f"{path}: cannot be written: {_reason(oiio, path, target)}")
    written = target.write_image(pixels)
    if not (target.close() and written):
        raise UsageError(f"{path}: cannot be written: {target.geterror()}")


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
