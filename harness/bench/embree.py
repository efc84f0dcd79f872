"""Embree, for comparison: nearest hits of the same rays, in float32, by every way that it has.

Two libraries are looked for: Embree 4 inside the package `embreex` (the optional extra `bench`),
and Debian's Embree 3 (libembree3-3) or another libembree; `CROSSTRACE_EMBREE` names others by their
files, as in a PATH. `embreex` itself offers triangles from Python only, so its library is
called directly. Spheres are Embree's own (sphere points), a plane is a
square of 2e5 world units around the foot of the perpendicular from the eye. Embree reads its own
records of rays, ray by ray or packets side by side, from memory; they are filled outside of the
time that is taken, which is that of the thread.
"""

from __future__ import annotations

import ctypes
import ctypes.util
import os
import time
from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crosstrace.harness.bench.rays import Rays
from crosstrace.native import _core
from crosstrace.translators.scene import Scene

#: From Embree's headers, the same in versions 3 and 4.
_QUAD, _SPHERE = 1, 50
_INDEX, _VERTEX = 0, 1
_UINT4, _FLOAT3, _FLOAT4 = 0x5004, 0x9003, 0x9004
_HIGH_QUALITY, _COHERENT = 2, 1
_VERSION_PROPERTY = 0

_HALF_WIDTH = 1e5
_MISSES = 0xFFFFFFFF
#: Words of a record: 12 of the ray, 8 of the hit, and one more in builds with arrays of instances.
_WORDS = 24
_FAR, _MASK, _PRIMITIVE, _GEOMETRY = 8, 9, 17, 18


def libraries() -> Iterator[Path | str]:
    """Yield what is there of Embree."""
    named = os.environ.get("CROSSTRACE_EMBREE")
    if named:
        yield from named.split(os.pathsep)
        return
    found = find_spec("embreex")
    if found is not None and found.origin:
        beside = Path(found.origin).parent.parent / "embreex.libs"
        yield from sorted(beside.glob("libembree*.so*"))
    system = ctypes.util.find_library("embree3") or ctypes.util.find_library("embree4")
    if system:
        yield system


class Embree:
    """One library with one scene in it; `modes` are its ways of asking."""

    def __init__(self, library: Path | str, scene: Scene) -> None:
        """Load the library and build the scene; raises OSError where it cannot be loaded."""
        self._rtc = rtc = ctypes.CDLL(str(library))
        for name in ("rtcNewDevice", "rtcNewScene", "rtcNewGeometry", "rtcSetNewGeometryBuffer"):
            getattr(rtc, name).restype = ctypes.c_void_p
        rtc.rtcGetDeviceProperty.restype = ctypes.c_ssize_t
        self._device = ctypes.c_void_p(rtc.rtcNewDevice(b"threads=1"))
        if not self._device:
            raise OSError(f"{library}: no device")
        number = rtc.rtcGetDeviceProperty(self._device, _VERSION_PROPERTY)
        self.version = f"{number // 10000}.{number // 100 % 100}.{number % 100}"
        self._is_old = number < 40000
        self.modes = ["single", "packet8", "packet16", *(["stream"] if self._is_old else [])]
        self._scene = ctypes.c_void_p(rtc.rtcNewScene(self._device))
        rtc.rtcSetSceneBuildQuality(self._scene, _HIGH_QUALITY)
        self._objects: list[NDArray[np.int64]] = []
        self._build(scene)
        rtc.rtcCommitScene(self._scene)
        # A context of version 3, the arguments of version 4.
        words = (_COHERENT, 0, 0, 0, _MISSES) if self._is_old else (0, _MISSES)
        self._context = np.zeros(32, np.uint32)
        self._context[: len(words)] = words

    def close(self) -> None:
        """Give the scene back."""
        self._rtc.rtcReleaseScene(self._scene)
        self._rtc.rtcReleaseDevice(self._device)

    def _build(self, scene: Scene) -> None:
        balls = np.flatnonzero(scene.is_sphere)
        if len(balls):
            self._add(_SPHERE, scene.geometry[balls, :4], _FLOAT4, None, balls)
        for i in np.flatnonzero(~scene.is_sphere):
            normal = scene.geometry[i, 3:] / np.linalg.norm(scene.geometry[i, 3:])
            foot = scene.eye + (normal @ (scene.geometry[i, :3] - scene.eye)) * normal
            across = np.cross(normal, np.eye(3)[np.abs(normal).argmin()])
            across *= _HALF_WIDTH / np.linalg.norm(across)
            down = np.cross(normal, across)
            signs = ((-1, -1), (1, -1), (1, 1), (-1, 1))
            corners = np.array([foot + a * across + b * down for a, b in signs])
            self._add(_QUAD, corners, _FLOAT3, np.arange(4), np.array([i]))

    def _add(
        self, kind: int, vertices: NDArray[Any], form: int, index: NDArray[Any] | None,
        objects: NDArray[np.int64],
    ) -> None:  # fmt: skip
        rtc = self._rtc
        geometry = ctypes.c_void_p(rtc.rtcNewGeometry(self._device, kind))
        self._fill(geometry, _VERTEX, form, vertices.astype(np.float32))
        if index is not None:
            self._fill(geometry, _INDEX, _UINT4, index.astype(np.uint32)[None])
        rtc.rtcCommitGeometry(geometry)
        rtc.rtcAttachGeometry(self._scene, geometry)
        rtc.rtcReleaseGeometry(geometry)
        self._objects.append(objects)

    def _fill(self, geometry: ctypes.c_void_p, kind: int, form: int, rows: NDArray[Any]) -> None:
        rows = np.ascontiguousarray(rows)
        stride, count = ctypes.c_size_t(rows[0].nbytes), ctypes.c_size_t(len(rows))
        place = self._rtc.rtcSetNewGeometryBuffer(geometry, kind, 0, form, stride, count)
        ctypes.memmove(place, rows.ctypes.data, rows.nbytes)

    def nearest(self, mode: str, rays: Rays) -> tuple[NDArray[np.int64], float]:
        """Return the objects (n,), -1 where nothing is hit, and the thread's seconds."""
        width = int(mode.removeprefix("packet")) if mode.startswith("packet") else 1
        record = 20 if width == 1 and self._is_old else _WORDS if width == 1 else 21
        n = -(-len(rays) // width) * width
        words, valid = self._records(rays, n, width, record), _aligned(width)
        valid[:] = _MISSES  # all bits: every ray of a packet counts
        raw, scene = words.ctypes.data, self._scene.value or 0
        context, stride = self._context.ctypes.data, 4 * record * width
        started = time.thread_time()
        if mode == "stream":
            count, step = ctypes.c_uint(n), ctypes.c_size_t(stride)
            self._rtc.rtcIntersect1M(self._scene, ctypes.c_void_p(context), ctypes.c_void_p(raw),
                                     count, step)  # fmt: skip
        else:
            query = ctypes.cast(getattr(self._rtc, f"rtcIntersect{width}"), ctypes.c_void_p).value
            lead = (scene,) if width == 1 else (valid.ctypes.data, scene)
            rest = (context, raw) if self._is_old else (raw, context)
            given = (*lead, *rest, 0)[:4]
            _core.call_each(query or 0, given, given.index(raw), stride, n // width)
        seconds = time.thread_time() - started
        return self._hits(words)[: len(rays)], seconds

    def _records(self, rays: Rays, n: int, width: int, record: int) -> NDArray[np.uint32]:
        """Return records of rays, side by side in packets: (packets, words, width)."""
        words = _aligned(n * record).reshape(n // width, record, width)
        floats = words.view(np.float32)
        for first, columns in ((0, rays.origins), (4, rays.directions)):
            for i in range(3):
                # What is left over is the last ray again.
                padded = np.pad(columns[i], (0, n - len(rays)), mode="edge")
                floats[:, first + i] = padded.reshape(-1, width)
        floats[:, _FAR] = np.inf
        words[:, _MASK] = _MISSES
        words[:, _GEOMETRY] = _MISSES
        words[:, _GEOMETRY + 1] = _MISSES
        return words

    def _hits(self, words: NDArray[np.uint32]) -> NDArray[np.int64]:
        geometry, primitive = words[:, _GEOMETRY].ravel(), words[:, _PRIMITIVE].ravel()
        hits = np.full(len(geometry), -1, np.int64)
        for number, objects in enumerate(self._objects):
            of_it = geometry == number
            hits[of_it] = objects[primitive[of_it]]
        return hits


def _aligned(n: int) -> NDArray[np.uint32]:
    """Return n zeros that start on a boundary of 64 bytes, as packets have to."""
    memory = np.zeros(n + 16, np.uint32)
    skipped = (-memory.ctypes.data % 64) // 4
    return memory[skipped : skipped + n]
