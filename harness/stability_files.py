"""The pictures and the record of a stability study, written whole or not at all.

A scene has `NAME-certified.png` (dark: certified; by reason where it is not),
`NAME-digits-RUNG.png` (bits that the rounding mode moves, on a ramp from none to all) and
`NAME-error-RUNG.png` (error against truth in decades from 1e-36 to 1; black: none, magenta:
undecidable).
"""

from __future__ import annotations

import json
import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from crosstrace.harness import colormap, images
from crosstrace.harness.stability import Entry, record
from crosstrace.translators.errors import UsageError
from crosstrace.translators.native.digits import DIGITS
from crosstrace.translators.native.stability import Stability
from crosstrace.translators.native.truth import PixelClass

JSON_NAME = "stability.json"

#: Error pictures run from here to 1: what float128 leaves is seen, too.
LEAST_DECADE = -36

#: Colours of `PixelClass`, 0…255 sRGB: certified is dark.
CLASS_COLORS = {
    PixelClass.CERTIFIED: (24, 32, 78),
    PixelClass.EDGE: (246, 230, 120),
    PixelClass.PRECISION: (255, 0, 255),
    PixelClass.BUDGET: (255, 120, 0),
}


def publish(done: Sequence[Entry], directory: Path) -> None:
    """Write every measured scene's pictures, then the record, which thus never names too much.

    Raises UsageError where the directory cannot be written.
    """
    written = record(done)
    try:
        directory.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(prefix=".crosstrace-", dir=directory) as name:
            built = Path(name)
            for entry, scene in zip(done, written["scenes"], strict=True):
                scene["pictures"] = []
                if entry.found is None:
                    continue
                for kind, picture in pictures(entry.found):
                    file = f"{entry.source.name}-{kind}.png"
                    images.write_pixels(built / file, picture)
                    scene["pictures"].append(file)
            text = json.dumps(written, indent=1, allow_nan=False) + "\n"
            (built / JSON_NAME).write_text(text, encoding="ascii")
            for file in (*sorted(p.name for p in built.glob("*.png")), JSON_NAME):
                (built / file).replace(directory / file)
    except OSError as error:
        raise UsageError(f"{directory}: cannot be written: {error.strerror}") from error


def pictures(found: Stability) -> Iterator[tuple[str, NDArray[np.uint8]]]:
    """Draw what was found: (kind, (v_res, h_res, 3) 8-bit sRGB)."""
    table = np.array([CLASS_COLORS[kind] for kind in PixelClass], np.uint8)
    yield "certified", table[found.known.pixel_class]
    for name, lost in found.digits.items():
        yield f"digits-{name}", colormap.ramp(lost / DIGITS[name])
    for rung in found.rungs:
        with np.errstate(divide="ignore"):
            decades = np.log10(rung.error_map)
        picture = colormap.ramp(1.0 - decades / LEAST_DECADE)
        picture[rung.error_map == 0.0] = colormap.NOTHING
        yield f"error-{rung.precision}", picture
