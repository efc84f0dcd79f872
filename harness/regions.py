"""Where the wrong and suspect pixels of an image lie, as connected regions in words.

Neighbours, diagonal ones too, are one region. A region is described by what the reference traces
there (the silhouette of an object, the edge of a shadow, a reflection, a refraction, a highlight)
and by a guess of what kind of fault it is.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crosstrace.translators.channels import largest

#: So many regions of a lane are described, the largest first.
DESCRIBED = 12

#: A region up to this size is a speckle.
_SPECKLE = 3

#: Terms of `contributions` (translators/native/adapter.py) and what a pixel ruled by one is called.
_TERMS = ("surface", "diffuse light", "highlight", "reflection", "refraction", "total reflection")

_SHIFTS = [(r, c) for r in (-1, 0, 1) for c in (-1, 0, 1) if (r, c) != (0, 0)]


@dataclass(frozen=True)
class Region:
    """A connected set of pixels: `box` is (top, left, bottom, right), the last two exclusive.

    `row`, `column` is the pixel that is furthest from the truth, by `difference`; `objects` are
    the indices of the objects first hit, −1 the background. `tree` outlines the reference's rays of
    that pixel (`ray_path.outline`), where it was asked for.
    """

    pixels: int
    box: tuple[int, int, int, int]
    row: int
    column: int
    difference: float
    where: str
    kind: str
    objects: tuple[int, ...]
    tree: str = ""


def find(
    which: NDArray[np.bool_],
    image: NDArray[np.float64],
    truth: NDArray[np.float64],
    layers: Mapping[str, NDArray[Any]],
) -> tuple[list[Region], int]:
    """Describe the regions of `which` (v_res, h_res), the largest first; return also their number.

    `truth` (v_res, h_res, 3) is a value inside each enclosure; `layers` are the native tracer's
    side outputs `object`, `tree` and `contributions`.
    """
    if not which.any():
        return [], 0
    from skimage.measure import label, regionprops

    labels = label(which, connectivity=2)
    found = sorted(regionprops(labels), key=lambda p: (-p.num_pixels, p.label))
    terms = _terms(layers)
    far = np.nan_to_num(largest(np.abs(image - truth)), nan=np.inf)
    regions = []
    for props in found[:DESCRIBED]:
        top, left, bottom, right = props.bbox
        inside = np.zeros(which.shape, bool)
        inside[top:bottom, left:right] = props.image
        row, column = np.unravel_index(int(np.argmax(np.where(inside, far, -1.0))), which.shape)
        objects = np.unique(layers["object"][inside])
        regions.append(
            Region(
                int(props.num_pixels),
                (top, left, bottom, right),
                int(row),
                int(column),
                float(far[row, column]),
                _where(inside, terms, layers["object"]),
                _kind(inside, image, truth),
                tuple(int(o) for o in objects[:8]),
            )
        )
    return regions, len(found)


def _edges(values: NDArray[Any]) -> NDArray[np.bool_]:
    """Say which pixels have a neighbour of another value."""
    edge = np.zeros(values.shape, bool)
    for axis in (0, 1):
        differ = np.diff(values, axis=axis) != 0
        low = [slice(None)] * 2
        high = [slice(None)] * 2
        low[axis], high[axis] = slice(None, -1), slice(1, None)
        edge[tuple(low)] |= differ
        edge[tuple(high)] |= differ
    return edge


def _terms(layers: Mapping[str, NDArray[Any]]) -> NDArray[np.intp]:
    """Return for each pixel what rules it: an edge first, else its largest contribution."""
    contributions = largest(layers["contributions"])
    ruling = np.argmax(contributions, axis=-1)
    silhouette, decision = _edges(layers["object"]), _edges(layers["tree"])
    lit = contributions[..., 1] + contributions[..., 2]
    secondary = contributions[..., 3:].sum(axis=-1)
    ruling = np.where(decision & (secondary <= lit), _SHADOW_EDGE, ruling)
    return np.where(silhouette, _SILHOUETTE, ruling)


_SILHOUETTE, _SHADOW_EDGE = len(_TERMS), len(_TERMS) + 1


def _where(inside: NDArray[np.bool_], terms: NDArray[np.intp], objects: NDArray[Any]) -> str:
    if inside.mean() > 0.5:
        return "the whole image"
    hit = int(np.bincount(objects[inside].astype(np.int64) + 1).argmax()) - 1
    thing = "the background" if hit < 0 else f"object {hit}"
    ruling = int(np.bincount(terms[inside]).argmax())
    if ruling == _SILHOUETTE:
        return f"the silhouette of {thing}"
    if ruling == _SHADOW_EDGE:
        return f"a shadow's edge on {thing}"
    return thing if ruling == 0 or hit < 0 else f"the {_TERMS[ruling]} of {thing}"


def _kind(inside: NDArray[np.bool_], image: NDArray[np.float64], truth: NDArray[np.float64]) -> str:
    """Guess what kind of fault it is: gain, shift, speckle or blob."""
    if (size := int(np.count_nonzero(inside))) <= _SPECKLE:
        return "speckle"
    mine, true = image[inside], truth[inside]
    if not np.isfinite(mine).all():
        return "not a number"
    bright = true > 0.02
    if bright.sum() >= size:
        ratio = mine[bright] / true[bright]
        gain = float(np.median(ratio))
        if abs(gain - 1) > 1e-4 and np.abs(ratio - gain).max() < 0.02 * abs(gain - 1) + 1e-6:
            return f"gain {gain:.4g}"
    error = float(np.abs(mine - true).mean())
    for rows, columns in _SHIFTS:
        moved = np.roll(truth, (rows, columns), axis=(0, 1))[inside]
        if float(np.abs(mine - moved).mean()) < 0.2 * error:
            return f"shift by {rows} rows, {columns} columns"
    return "blob"
