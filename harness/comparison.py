"""Two images compared: every number about them in one record."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass
from typing import Any

from crosstrace.harness import metrics, ssim
from crosstrace.harness.bands import Rows, side_by_side
from crosstrace.harness.metrics import Metrics, checked_pair, measure
from crosstrace.harness.ssim import Similarity, similarity
from crosstrace.translators.errors import UsageError
from crosstrace.translators.scene import Scene


@dataclass(frozen=True)
class Comparison:
    """Numbers on linear float (`metrics`) and on the display colour (`similarity`)."""

    metrics: Metrics
    similarity: Similarity

    @property
    def ssim(self) -> float | None:
        """The mean structural similarity; None where it is undefined."""
        return self.similarity.mean

    def record(self) -> dict[str, Any]:
        """Return the keys of a report's pair, JSON-ready: what is not finite is None."""
        numbers = asdict(self.metrics)
        over = numbers.pop("over")
        plain: dict[str, Any] = _finite({**numbers, **over, "ssim": self.ssim})
        return plain


def compare(a: Any, b: Any, scene: Scene | None = None) -> Comparison:
    """Compare two linear images (v_res, h_res, 3), row 0 at the top.

    Raises UsageError where the shapes differ from each other or from that of `scene`.
    """
    first, second = checked_pair(a, b)
    _check_size(first.shape, scene)
    return Comparison(measure(first, second), similarity(first, second))


def compare_rows(first: Rows, second: Rows, scene: Scene | None = None) -> Comparison:
    """As `compare`, of images that are read in bands: the same numbers, without the map."""
    if first.shape != second.shape:
        sizes = " and ".join(f"{image.shape[0]}x{image.shape[1]}" for image in (first, second))
        raise UsageError(f"expected two images of one size, found {sizes} (rows x columns)")
    _check_size(first.shape, scene)
    numbers, alike = metrics.Tally(), ssim.Tally(first.shape)
    for row, a, b in side_by_side(first, second):
        numbers.add(row, a, b)
        alike.add(a, b)
    return Comparison(numbers.metrics(), alike.similarity())


def _check_size(shape: tuple[int, ...], scene: Scene | None) -> None:
    if scene is not None and shape != scene.shape:
        expected, found = (f"{size[0]}x{size[1]}" for size in (scene.shape, shape))
        raise UsageError(f"expected images of the scene's size {expected}, found {found}")


def _finite(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _finite(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(item) for item in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
