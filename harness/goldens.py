"""Goldens: what a scene came out as when somebody accepted it, in two files a scene.

`NAME.npz` holds the fingerprint of the native tracer (`fingerprint.py`) and the class of every
pixel of every lane at full size; `NAME.json` the verdict, counts and metrics, where they came from,
and why they were accepted, each time. The JSON names the hash of its arrays: two files that do not
belong together are told. A file that is no golden is never overwritten.
"""

from __future__ import annotations

import zipfile
from collections.abc import Mapping
from dataclasses import dataclass
from datetime import UTC, datetime
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crosstrace.harness import images, record
from crosstrace.harness.fingerprint import Fingerprint
from crosstrace.harness.names import slug
from crosstrace.translators.errors import UsageError

SCHEMA = "crosstrace-golden/1"

Classes = Mapping[str, NDArray[np.uint8]]

#: Keys of a lane's record that a golden keeps.
_OF_LANE = ("name", "version", "status", "message", "half_step", "tolerance", "classes", "settings",
            "ledger")  # fmt: skip
_NOT_OF_PAIR = ("worst", "images", "message")


@dataclass(frozen=True)
class Golden:
    """An accepted result: its JSON, the fingerprint, and the classes (v_res, h_res) by lane."""

    about: Mapping[str, Any]
    fingerprint: Fingerprint
    classes: Classes

    @property
    def lanes(self) -> dict[str, Mapping[str, Any]]:
        """The lanes' records by name."""
        return {lane["name"]: lane for lane in self.about["lanes"]}

    @property
    def reason(self) -> str:
        """Why it was accepted last."""
        return str(self.about["history"][-1]["reason"])


@dataclass(frozen=True)
class Reference:
    """A folder of goldens; `packaged`: the one that came with this package."""

    folder: Path
    packaged: bool

    def check_writable(self) -> None:
        """Raise UsageError where the folder is that of an installed package."""
        if self.packaged and not (self.folder.parent / "pyproject.toml").is_file():
            raise UsageError(
                "the goldens of an installed package are not written to: work in a checkout of the "
                "project, or name a folder of your own with --reference"
            )

    def read(self, name: str) -> Golden | None:
        """Return the golden of a scene, None where there is none.

        Raises UsageError for files that are no golden, or not of each other.
        """
        text, arrays = self._files(name)
        if not text.is_file():
            if arrays.is_file():
                raise UsageError(f"{arrays}: expected {text.name} beside it, found none")
            return None
        about = record.loads(text, SCHEMA, "golden")
        try:
            if images.sha256(arrays) != about["arrays_sha256"]:
                raise UsageError(f"{arrays}: expected the arrays that {text.name} names by hash")
            with np.load(arrays, allow_pickle=False) as data:
                fingerprint = Fingerprint(
                    data["image"], data["trees"], data["row_digests"], data["column_digests"],
                    about["trees_sha256"],
                )  # fmt: skip
                shape = about["scene"]["v_res"], about["scene"]["h_res"]
                classes = {
                    lane["name"]: _unpacked(data, f"classes_{i}", shape)
                    for i, lane in enumerate(about["lanes"])
                    if lane["status"] == "ok"
                }
        except OSError as error:
            raise UsageError(f"{arrays}: cannot be read: {error.strerror}") from error
        except (KeyError, ValueError, TypeError, zipfile.BadZipFile) as error:
            raise UsageError(f"{text}: expected a golden, found: {error!r}") from error
        return Golden(about, fingerprint, classes)

    def write(self, name: str, golden: Golden) -> int:
        """Write a golden, each file whole or not at all; return the bytes of both.

        Raises UsageError where the folder cannot be written or holds another's files.
        """
        self.check_writable()
        text, arrays = self._files(name)
        self.read(name)  # refuses what is no golden
        try:
            self.folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise UsageError(f"{self.folder}: cannot be written: {error.strerror}") from error
        print_ = golden.fingerprint
        data: dict[str, NDArray[Any]] = {
            "image": print_.image, "trees": print_.trees,
            "row_digests": print_.row_digests, "column_digests": print_.column_digests,
        }  # fmt: skip
        for i, lane in enumerate(golden.about["lanes"]):
            if (classes := golden.classes.get(lane["name"])) is not None and classes.any():
                data[f"classes_{i}"] = classes
        images.write_arrays(arrays, data)
        about = {**golden.about, "arrays_sha256": images.sha256(arrays)}
        images.write_bytes(text, record.dumps(about).encode())
        return text.stat().st_size + arrays.stat().st_size

    def _files(self, name: str) -> tuple[Path, Path]:
        stem = slug(name, set())
        return self.folder / f"{stem}.json", self.folder / f"{stem}.npz"


def located(folder: Path | None) -> Reference:
    """Return a folder of goldens; None: the packaged one."""
    if folder is None:
        return Reference(Path(str(files("crosstrace.reference"))), True)
    if folder.exists() and not folder.is_dir():
        raise UsageError(f"{folder}: expected a folder of goldens, found a file")
    return Reference(folder, False)


def made(
    scene: Mapping[str, Any],
    environment: Mapping[str, Any],
    fingerprint: Fingerprint,
    classes: Classes,
    reason: str,
    before: Golden | None,
) -> Golden:
    """Make a golden from a scene's record of a run; the history of `before` is kept."""
    rows, columns, _ = fingerprint.image.shape
    history = list(before.about["history"]) if before else []
    history.append(
        {
            "date": datetime.now(UTC).isoformat(timespec="seconds"),
            "reason": reason,
            "verdict": scene["verdict"],
            "blame": list(scene["blame"]),
            "scene_sha256": scene["sha256"],
            "crosstrace": environment["crosstrace"],
        }
    )
    about = {
        "schema": SCHEMA,
        "name": scene["name"],
        "scene": {key: scene[key] for key in ("sha256", "delivery", "v_res", "h_res", "effects")},
        "verdict": scene["verdict"],
        "blame": list(scene["blame"]),
        "truth": scene["judgement"].get("truth"),
        "reduced": [rows, columns],
        "trees_sha256": fingerprint.sha256,
        "lanes": [{key: lane[key] for key in _OF_LANE} for lane in scene["renderers"]],
        "pairs": [
            {key: value for key, value in pair.items() if key not in _NOT_OF_PAIR}
            for pair in scene["pairs"]
        ],
        "environment": {k: v for k, v in environment.items() if k not in ("memory_mib", "cores")},
        "history": history,
    }
    return Golden(about, fingerprint, classes)


def _unpacked(data: Any, key: str, shape: tuple[int, int]) -> NDArray[np.uint8]:
    """Return a lane's classes; all are equal where none are stored."""
    classes: NDArray[np.uint8] = data[key] if key in data else np.zeros(shape, np.uint8)
    if classes.shape != shape:
        raise ValueError(f"classes of shape {classes.shape} instead of {shape}")
    return classes
