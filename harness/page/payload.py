"""What the page holds of a scene's pixels: the first picture as it is, all else packed.

The first lane's PNG goes in as it stands. The other pictures are packed as their 8-bit differences
from it, modulo 256, which are nearly all 0; the maps of a byte a pixel and the exact pixels as they
are. Packed means deflated and in base64: a browser unpacks it exactly, without a network.
"""

from __future__ import annotations

import base64
import binascii
import json
import zipfile
import zlib
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crosstrace.harness import colormap, images, maps
from crosstrace.translators.errors import UsageError


@dataclass
class Payload:
    """A scene's pixels for the page.

    `picture` is a data URI, empty where there is no image; `data` becomes JSON for the script;
    `troubles` say which files could not be used and why.
    """

    picture: str = ""
    data: dict[str, Any] = field(default_factory=dict)
    troubles: list[str] = field(default_factory=list)

    @property
    def size(self) -> int:
        """How much of the page it takes, in bytes."""
        return len(self.picture) + len(json.dumps(self.data))

    def reduced(self) -> Payload:
        """Return only what is small and worth most: the exact pixels, no picture and no map."""
        lanes = [lane | {"delta": None, "classes": None} for lane in self.data["lanes"]]
        data = self.data | {"lanes": lanes, "maps": {}, "objects": None}
        why = "the pictures and maps: the page would be too large; the files beside it have them"
        return Payload("", data, [*self.troubles, why])


class _UnusableError(Exception):
    """A file is not there or not the one that the record names."""


def payload(scene: Mapping[str, Any], folder: Path) -> Payload:
    """Pack the pixels of one scene of a record; its files are looked for in `folder`."""
    made = Payload()
    shape = scene["v_res"], scene["h_res"]
    first: NDArray[np.uint8] | None = None
    lanes = []
    for entry in scene["renderers"]:
        lane: dict[str, Any] = {"name": entry["name"], "delta": None, "classes": None}
        lanes.append(lane)
        try:
            if "png" in entry["images"]:
                file = _file(entry["images"]["png"], folder)
                pixels = _eight_bit(file, shape)
                if first is None:
                    first = pixels
                    made.data["base"] = entry["name"]
                    encoded = base64.b64encode(file.read_bytes()).decode()
                    made.picture = f"data:image/png;base64,{encoded}"
                lane["delta"] = _packed(pixels - first)
            if "classes" in entry["images"]:
                drawn = _eight_bit(_file(entry["images"]["classes"], folder), shape)
                lane["classes"] = _packed(colormap.classes_of_picture(drawn))
        except (_UnusableError, UsageError, OSError, ValueError) as error:
            made.troubles.append(f"{entry['name']}: {error}")
    made.data |= {"rows": shape[0], "columns": shape[1], "lanes": lanes}
    made.data["maps"] = _maps(scene, folder, made.troubles)
    for name, read in (("objects", _objects), ("pixels", _pixels)):
        made.data[name] = None
        if name in scene["images"]:
            try:
                made.data[name] = read(_file(scene["images"][name], folder), shape)
            except (_UnusableError, OSError, ValueError, KeyError, zipfile.BadZipFile) as error:
                made.troubles.append(f"{name}: {error}")
    return made


def _maps(scene: Mapping[str, Any], folder: Path, troubles: list[str]) -> dict[str, Any]:
    """Return the maps of every lane against the first, by lane."""
    found: dict[str, Any] = {}
    for pair in scene["pairs"]:
        if pair["a"] != scene["renderers"][0]["name"] or "maps" not in pair["images"]:
            continue
        try:
            read = maps.read(_file(pair["images"]["maps"], folder))
            found[pair["b"]] = {name: _packed(_checked(map_, scene)) for name, map_ in read.items()}
        except (_UnusableError, OSError, ValueError, zipfile.BadZipFile) as error:
            troubles.append(f"{pair['a']} and {pair['b']}: {error}")
    return found


def _checked(map_: NDArray[Any], scene: Mapping[str, Any]) -> NDArray[Any]:
    if map_.shape != (scene["v_res"], scene["h_res"]) or map_.dtype != np.uint8:
        raise ValueError("expected a map of a byte a pixel")
    return map_


def _objects(file: Path, shape: tuple[int, int]) -> dict[str, Any]:
    """Pack the objects, counted from 1 (0: none), in as few bytes a pixel as they take."""
    objects = maps.read(file)["object"].astype("<i8") + 1
    if objects.shape != shape:
        raise ValueError(f"expected a map of {shape}, found {objects.shape}")
    size = next(n for n in (1, 2, 4) if int(objects.max(initial=0)) < 256**n)
    return {"bytes": size, "map": _packed(objects.astype(f"<u{size}"))}


def _pixels(file: Path, shape: tuple[int, int]) -> str:
    read = json.loads(file.read_text(encoding="utf-8"))
    return _pack(json.dumps(read, separators=(",", ":"), allow_nan=False).encode())


def _eight_bit(file: Path, shape: tuple[int, int]) -> NDArray[np.uint8]:
    pixels = np.rint(images.read(file) * 255).astype(np.uint8)
    if pixels.shape[:2] != shape:
        raise ValueError(f"expected {shape[0]} x {shape[1]} pixels, found {pixels.shape[:2]}")
    return pixels


def _file(entry: Mapping[str, str], folder: Path) -> Path:
    """Return the file of a record's entry; it must be inside the folder and of that hash."""
    file = folder / entry["file"]
    if not file.resolve().is_relative_to(folder.resolve()):
        raise _UnusableError(f"{entry['file']} is not a file of this report")
    if not file.is_file():
        raise _UnusableError(f"{entry['file']} is not there")
    if images.sha256(file) != entry["sha256"]:
        raise _UnusableError(f"{entry['file']} is not the file that the record names")
    return file


def _packed(array: NDArray[Any]) -> str:
    # Maps are runs and noise: looking for runs alone is sixty times as fast as looking for repeats,
    # and the result is one per cent larger.
    return _pack(np.ascontiguousarray(array).tobytes(), zlib.Z_RLE)


def _pack(content: bytes, strategy: int = zlib.Z_DEFAULT_STRATEGY) -> str:
    deflater = zlib.compressobj(strategy=strategy)
    packed = deflater.compress(content) + deflater.flush()
    return binascii.b2a_base64(packed, newline=False).decode()
