"""POV-Ray's own settings, by name: what one may turn to trade time for accuracy.

| name | values | default | what it does |
|---|---|---|---|
| `antialias` | `off`, a threshold from 0 | `off` | more samples where colours differ more (`+A`) |
| `antialias_depth` | 1 to 9 | 3 | samples a side (`+R`); of method 2 the levels of halving |
| `antialias_method` | 1, 2 | 1 | 1: against neighbours; 2: within a pixel, by halving (`+AM`) |
| `output_scale` | `auto`, a number from 1 | `auto` | the scale K to begin with (`output.py`) |

Threshold 0 samples every pixel. Colours are compared as they are written, thus divided by K.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from crosstrace.translators.errors import UsageError

#: Name → what is expected of it.
EXPECTED = {
    "antialias": "off or a threshold from 0 to 3",
    "antialias_depth": "an integer from 1 to 9",
    "antialias_method": "1 or 2",
    "output_scale": "auto or a number from 1 to 1e6",
}


@dataclass(frozen=True)
class Tuning:
    """The settings, read; `threshold` None: one ray a pixel, `output_scale` None: by the scene."""

    threshold: float | None = None
    depth: int = 3
    method: int = 1
    output_scale: float | None = None

    @property
    def switches(self) -> list[str]:
        """The command line's switches for antialiasing, without jitter."""
        if self.threshold is None:
            return []
        return [f"+AM{self.method}", f"+R{self.depth}", f"+A{self.threshold!r}", "-J"]


def read(texts: Mapping[str, str]) -> Tuning:
    """Read settings by name; raises UsageError for an unknown name or value."""
    for name in texts:
        if name not in EXPECTED:
            raise UsageError(f"povray's settings: expected {', '.join(EXPECTED)}, found {name!r}")
    return Tuning(
        _number(texts, "antialias", "off", 0.0, 3.0),
        int(_number(texts, "antialias_depth", "", 1, 9, whole=True) or 3),
        int(_number(texts, "antialias_method", "", 1, 2, whole=True) or 1),
        _number(texts, "output_scale", "auto", 1.0, 1e6),
    )


def _number(
    texts: Mapping[str, str], name: str, none: str, least: float, most: float, whole: bool = False
) -> float | None:
    text = texts.get(name, none)
    if text == none:
        return None
    try:
        value = float(text)
    except ValueError:
        value = float("nan")
    # A NaN is in no range.
    if not least <= value <= most or (whole and value != int(value)):
        raise UsageError(f"povray's {name}: expected {EXPECTED[name]}, found {text!r}")
    return value
