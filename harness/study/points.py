"""The points of a study: every way of spending time on a scene that is tried.

A point is a renderer with settings, and the kind of its error. Kinds are never mixed:

| kind | what differs | against |
|---|---|---|
| `rounding` | the arithmetic, and the rounding of the output | the certified value |
| `certified` | nothing: the error is half the width of a rigorous enclosure | |
| `model` | what a renderer does by rules of its own, beside rounding | the certified value |
| `offset` | ε of shadow and secondary rays, beside rounding | the certified value |
| `pruning` | rays left out as they hardly matter | the certified value |
| `depth` | the number of bounces | the deep render |
| `sampling` | the samples of a pixel's area | the converged average |
"""

from __future__ import annotations

import shlex
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from crosstrace.translators.effects import effects
from crosstrace.translators.native.adapter import present
from crosstrace.translators.renderer import RenderOptions
from crosstrace.translators.sampling import CENTRE, Sampling
from crosstrace.translators.scene import Scene

KINDS = ("rounding", "certified", "model", "offset", "pruning", "depth", "sampling")

#: What each kind is measured against.
AGAINST = {
    **dict.fromkeys(KINDS, "certified"), "depth": "deep", "sampling": "average",
}  # fmt: skip

#: ε in world units, by precision: from far too large to none.
EPSILONS = {
    "f64": ("1e-1", "1e-2", "1e-3", "1e-4", "1e-6", "1e-8", "1e-10", "1e-12", "1e-13", "1e-14"),
    "f32": ("1e-2", "1e-3", "1e-4", "1e-6", "1e-7"),
}
TOLERANCES = (1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-8, 1e-10)

#: Samples a side.
SIDES = (1, 2, 3, 4, 6, 8, 12, 16, 24, 32)

#: Of a renderer that renders a finer frame in one piece.
FOREIGN_SIDES = (2, 4)

#: POV-Ray's scale of its output, beside the one that it takes by itself.
OUTPUT_SCALES = ("1", "16")

#: POV-Ray's own antialiasing: threshold, method, depth.
ANTIALIAS = (("0.3", 1, 3), ("0.1", 1, 4), ("0.1", 2, 2), ("0.1", 2, 3), ("0.03", 2, 4))


@dataclass(frozen=True)
class Point:
    """One renderer with settings, and the kind of error that they are tried for."""

    renderer: str
    kind: str
    precision: str = "f64"
    epsilon: str = ""
    tolerance: float = 0.0
    max_depth: int | None = None
    sampling: Sampling = CENTRE
    tuning: Mapping[str, str] = field(default_factory=dict)
    certify: bool = False

    @property
    def settings(self) -> dict[str, Any]:
        """What differs from the renderer's defaults, JSON-ready; of native always its precision."""
        chosen = {
            "precision": self.precision if self.renderer == "native" else None,
            "epsilon": self.epsilon and float(self.epsilon),
            "tolerance": self.tolerance,
            "max_depth": self.max_depth,
            "sampling": "" if self.sampling == CENTRE else str(self.sampling),
            **self.tuning,
        }
        kept = {k: v for k, v in chosen.items() if v not in (None, "") and v is not False}
        if not self.tolerance:
            kept.pop("tolerance")
        return {**kept, **({"certify": True} if self.certify else {})}

    @property
    def label(self) -> str:
        """The settings in few characters."""
        tuned = {"antialias": "A", "antialias_depth": "R", "antialias_method": "M",
                 "output_scale": "K="}  # fmt: skip
        words = [
            f"{self.precision}" if self.renderer == "native" else "",
            f"eps={self.epsilon}" if self.epsilon else "",
            f"tol={self.tolerance:g}" if self.tolerance else "",
            "" if self.max_depth is None else f"depth={self.max_depth}",
            "" if self.sampling == CENTRE else str(self.sampling),
            "".join(f"{tuned[name]}{text}" for name, text in self.tuning.items()),
            "certify" if self.certify else "",
        ]
        return " ".join(word for word in words if word) or "default"

    def scene(self, scene: Scene) -> Scene:
        """Return the scene with this point's number of bounces."""
        if self.max_depth is None or self.max_depth == scene.max_depth:
            return scene
        return replace(scene, max_depth=self.max_depth, checked=False)

    def options(self, threads: int, timeout_s: float | None) -> RenderOptions:
        """Return how its renderer is asked for it."""
        readings = {"epsilon": self.epsilon} if self.epsilon else {}
        return RenderOptions(threads, readings, self.precision, timeout_s=timeout_s,
                             tolerance=self.tolerance, sampling=self.sampling,
                             tuning=self.tuning)  # fmt: skip

    def command(self, scene: str, size: tuple[int, int] | None, threads: int) -> str:
        """Return the line that renders it; the image is image.npy, or .npz with enclosures."""
        words = ["crosstrace", "render", scene, "--with", self.renderer]
        words += ["--precision", self.precision] if self.precision != "f64" else []
        words += ["--set", f"epsilon={self.epsilon}"] if self.epsilon else []
        words += ["--tolerance", f"{self.tolerance:g}"] if self.tolerance else []
        words += [] if self.max_depth is None else ["--max-depth", str(self.max_depth)]
        words += ["--sampling", str(self.sampling)] if self.sampling != CENTRE else []
        for name, text in self.tuning.items():
            words += ["--tune", f"{name}={text}"]
        words += ["--certify"] if self.certify else []
        words += ["--size", f"{size[0]}x{size[1]}"] if size else []
        words += ["--threads", str(threads)] if threads else []
        words += ["-o", "image.npz" if self.certify else "image.npy"]
        return shlex.join(words)


def bounces(scene: Scene) -> bool:
    """Say whether a scene sends secondary rays where its depth allows it."""
    if scene.delivery < 3:
        return False
    deeper = replace(scene, max_depth=max(1, scene.max_depth), checked=False)
    found = effects(deeper).names
    return bool({"reflection", "refraction", "total_reflection"} & {*found})


def plan(
    scene: Scene, lanes: Sequence[str], sides: Sequence[int], depths: Sequence[int]
) -> Iterator[Point]:
    """Give the points of a scene; `depths` are the numbers of bounces to try."""
    foreign = [lane for lane in lanes if lane != "native"]
    if "native" in lanes:
        yield from (Point("native", "rounding", precision) for precision in present())
        yield Point("native", "certified", certify=True)
        yield from _native(scene, depths)
        yield from _sampled(sides)
    for lane in foreign:
        yield Point(lane, "rounding")
        for side in FOREIGN_SIDES:
            if side <= max(sides):
                yield Point(lane, "sampling", sampling=Sampling("regular", side))
    if "povray" in lanes:
        for scale in OUTPUT_SCALES:
            yield Point("povray", "rounding", tuning={"output_scale": scale})
        for threshold, method, depth in ANTIALIAS:
            if depth <= max(sides):
                yield Point("povray", "sampling", tuning={
                    "antialias": threshold, "antialias_method": str(method),
                    "antialias_depth": str(depth),
                })  # fmt: skip


def _native(scene: Scene, depths: Sequence[int]) -> Iterator[Point]:
    if "shadows" in effects(scene).names or (bounces(scene) and scene.max_depth > 0):
        for precision, epsilons in EPSILONS.items():
            yield from (Point("native", "offset", precision, epsilon=it) for it in epsilons)
    if bounces(scene):
        yield from (Point("native", "depth", max_depth=depth) for depth in depths)
        if scene.max_depth > 0:
            yield from (Point("native", "pruning", tolerance=it) for it in TOLERANCES)


def _sampled(sides: Sequence[int]) -> Iterator[Point]:
    for side in sides:
        yield Point("native", "sampling", sampling=Sampling("regular", side))
        yield Point("native", "sampling", "f32", sampling=Sampling("regular", side))
        if side > 1:
            yield Point("native", "sampling", sampling=Sampling("jittered", side))
        if side > 2:
            yield Point("native", "sampling", sampling=Sampling("adaptive", side))
            yield Point("native", "sampling", "f32", sampling=Sampling("adaptive", side))
