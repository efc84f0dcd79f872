"""The pixels of a scene that a report shows exactly: values of all lanes, enclosure, ray tree.

Only pixels that differ are of interest, and a report cannot hold them all: each lane's regions of
unexplained pixels come first, then in turn the furthest pixels of each class of each lane, from
`wrong` down to `rounding`, and the furthest from the reference. What was left out is counted.
`record` documents the file that holds them.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import chain, islice, zip_longest
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from crosstrace.harness.classes import NAMES, Class
from crosstrace.harness.explain import enclosure_at, enclosure_record
from crosstrace.translators.channels import largest
from crosstrace.translators.errors import RendererError
from crosstrace.translators.native import truth
from crosstrace.translators.native.explain import Ray, explain
from crosstrace.translators.scene import Scene

if TYPE_CHECKING:
    from crosstrace.harness.judging import Judgement

SCHEMA = "crosstrace-pixels/1"

#: Pixels of a scene that are kept, the first of them with their ray trees, each so far.
MOST_PIXELS, MOST_TREES, MOST_RAYS = 240, 80, 120

#: The furthest pixels from the reference, of each lane, whatever their class.
_FURTHEST = 8

_OF_RAY = ("parent", "depth", "object", "light", "inside", "weight", "t_world", "light_distance",
           "margin", "margin_object", "clearance")  # fmt: skip


def record(
    scene: Scene,
    images: Mapping[str, NDArray[np.float64]],
    judged: Judgement,
    far: Mapping[str, NDArray[np.float64]],
    readings: Mapping[str, str],
    threads: int = 0,
) -> dict[str, Any]:
    """Return the pixels to show of some lanes' images (v_res, h_res, 3), for JSON.

    `far` is how far each pixel of a lane lies outside of what is possible. The keys: `schema`;
    `beyond`, how many pixels are not `equal` in every lane; `pixels[]`: `row`, `col`,
    `object` (first hit; -1: none, null: no tree), `enclosure` as in `crosstrace explain --json`,
    `lanes` by name {`value` [r, g, b], `class`, `off`: how far outside
    of what is possible}, and `tree`, null beyond the first `MOST_TREES`: {`n_rays`, `rays[]`: the
    first of them, of six significant digits}. What is not there is null.
    """
    peaks = [
        [region.row * scene.h_res + region.column for region in regions]
        for regions, _ in judged.found.values()
    ]
    wanted = chain(_in_turn(peaks), _in_turn(list(_lists(images, judged, far))))
    chosen = list(islice(dict.fromkeys(wanted), MOST_PIXELS))
    known = truth.certify(scene, readings, pixels=np.array(chosen, np.int64), threads=threads)
    pixels = []
    for i, at in enumerate(chosen):
        row, col = divmod(at, scene.h_res)
        tree = _tree(scene, row, col, readings) if i < MOST_TREES else None
        pixels.append({
            "row": row,
            "col": col,
            "object": tree["rays"][0]["object"] if tree else None,
            "enclosure": enclosure_record(enclosure_at(known, i)),
            "lanes": {
                lane: {
                    "value": image[row, col].tolist(),
                    "class": NAMES[judged.classified[lane].classes[row, col]],
                    "off": float(far[lane][row, col]),
                }
                for lane, image in images.items()
            },
            "tree": tree,
        })  # fmt: skip
    beyond = np.zeros(scene.shape[:2], bool)
    for classified in judged.classified.values():
        beyond |= classified.classes != Class.EQUAL
    return {"schema": SCHEMA, "beyond": int(np.count_nonzero(beyond)), "pixels": pixels}


def _lists(
    images: Mapping[str, NDArray[np.float64]],
    judged: Judgement,
    far: Mapping[str, NDArray[np.float64]],
) -> Iterator[Sequence[int]]:
    """Yield lists of pixels (row * h_res + column), each in the order of its interest."""
    first = next(iter(images.values()))
    for kind in reversed(Class):
        if kind == Class.EQUAL:
            continue
        for lane, classified in judged.classified.items():
            inside = np.flatnonzero(classified.classes == kind)
            order = np.argsort(-far[lane].ravel()[inside], kind="stable")
            yield inside[order[:MOST_PIXELS]].tolist()
    for image in images.values():
        with np.errstate(invalid="ignore"):
            off = np.nan_to_num(largest(np.abs(image - first)), nan=np.inf).ravel()
        count = min(_FURTHEST, off.size)
        furthest = np.argpartition(-off, count - 1)[:count]
        yield [int(at) for at in sorted(furthest, key=lambda at: -off[at]) if off[at] > 0]


def _in_turn(lists: Sequence[Sequence[int]]) -> Iterator[int]:
    """Take one of each list in turn."""
    return (at for turn in zip_longest(*lists) for at in turn if at is not None)


def _tree(scene: Scene, row: int, col: int, readings: Mapping[str, str]) -> dict[str, Any] | None:
    try:
        tree = explain(scene, row, col, readings, max_rays=MOST_RAYS)
    except RendererError:
        return None
    return {"n_rays": tree.n_rays, "rays": [_ray(ray) for ray in tree.rays]}


def _ray(ray: Ray) -> dict[str, Any]:
    kept = {name: _short(getattr(ray, name)) for name in _OF_RAY}
    # Of many thousand rays: `dataclasses.asdict` would copy each as deep as it goes.
    names = {"kind": ray.kind.name.lower(), "margin_decision": ray.margin_decision.name.lower()}
    return kept | names | {"adds": [_short(channel) for channel in ray.contribution]}


def _short(value: Any) -> Any:
    return float(f"{value:.6g}") if isinstance(value, float) else value
