"""The jobs of a run that read and write pixels where the worker is, and return small records.

A rendering leaves its float64 pixels in a scratch file for the comparisons and its views in the
report's folder; a comparison reads two such files. File names in records are relative to the
report.
"""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crosstrace.harness import colormap, images, maps, record, tasks
from crosstrace.harness.flip import flip
from crosstrace.harness.lanes import loaded
from crosstrace.harness.metrics import difference, measure, pixel_difference
from crosstrace.harness.spread import quantile, spread
from crosstrace.harness.ssim import similarity
from crosstrace.translators.renderer import Progress, RenderOptions
from crosstrace.translators.scene import Scene


@dataclass(frozen=True)
class Place:
    """Where files go: `root` is the report's directory, `stem` the relative name without suffix."""

    root: Path
    stem: str

    def file(self, suffix: str) -> Path:
        """Return a file's path; its folder is made."""
        path = self.root / (self.stem + suffix)
        path.parent.mkdir(parents=True, exist_ok=True)
        return path

    def entry(self, suffix: str) -> dict[str, str]:
        """Return the record of a written file: its name from the report, the hash of its bytes."""
        return {"file": self.stem + suffix, "sha256": images.sha256(self.file(suffix))}


def render_to_files(
    lane: str,
    scene: Scene,
    options: RenderOptions,
    version: str,
    pixels: Path,
    place: Place,
    progress: Progress | None = None,
) -> dict[str, Any]:
    """Render; leave float64 pixels in `pixels`, an EXR and a PNG at `place`; return the record."""
    made, peak_mib = tasks.render(lane, scene, options, progress)
    np.save(pixels, made.image, allow_pickle=False)
    metadata = {
        "scene": scene.name,
        "scene_sha256": scene.sha256,
        "renderer": lane,
        "renderer_version": version,
        "settings": json.dumps(made.settings, default=str),
    }
    for suffix in (".exr", ".png"):
        images.write(place.file(suffix), made.image, metadata=metadata)
    finite = np.isfinite(made.image).all(axis=2)
    return {
        "status": "ok",
        "message": "",
        "seconds": asdict(made.seconds),
        "peak_mib": peak_mib,
        "half_step": made.half_step,
        "nonfinite": int(finite.size - np.count_nonzero(finite)),
        "settings": made.settings,
        "messages": made.messages,
        "ledger": record.ledger(loaded(lane).ledger(scene)),
        "images": {"exr": place.entry(".exr"), "png": place.entry(".png")},
    }


def compare_files(a: Path, b: Path, place: Place, version: str) -> dict[str, Any]:
    """Compare two scratch files; leave pictures of difference and similarity at `place`."""
    first, second = np.load(a, mmap_mode="r"), np.load(b, mmap_mode="r")
    numbers = measure(first, second)
    alike = similarity(first, second)
    per_pixel = pixel_difference(difference(first, second))
    names = {"crosstrace:version": version}
    layers = {"difference": maps.difference(first, second), "digits": maps.digits(first, second)}
    pictures = {"difference": colormap.difference_picture(per_pixel)}
    if alike.map is not None:
        pictures["ssim"] = colormap.similarity_picture(alike.map)
        layers["unlike"] = maps.unlike(alike.map)
    maps.write(place.file(".maps.npz"), layers)
    drawn = {
        kind: _picture(place, f".{kind}.png", picture, names) for kind, picture in pictures.items()
    }
    return {
        "max": numbers.max,
        "mean": numbers.mean,
        "bias": numbers.bias,
        "rmse": numbers.rmse,
        "psnr": numbers.psnr,
        "p999": quantile(per_pixel),
        "ssim": alike.mean,
        "flip": flip(first, second),
        **numbers.over,
        "pixels": numbers.pixels,
        "differing": numbers.differing,
        "nonfinite": numbers.nonfinite,
        "worst": [asdict(pixel) for pixel in numbers.worst],
        "message": "",
        "spread": spread(per_pixel),
        "images": {**drawn, "maps": place.entry(".maps.npz")},
    }


def _picture(
    place: Place, suffix: str, pixels: NDArray[np.uint8], metadata: dict[str, str]
) -> dict[str, str]:
    images.write_pixels(place.file(suffix), pixels, metadata)
    return place.entry(suffix)
