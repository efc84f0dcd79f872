"""The one small interface through which the harness sees a renderer.

A renderer translates a Scene and renders it in the calling process; isolating it, timing it out and
judging its image are the harness's work. A new renderer is one folder beside this file and one line
in `registry.py`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from crosstrace.translators.ledger import Ledger
from crosstrace.translators.sampling import CENTRE, Sampling
from crosstrace.translators.scene import Scene

#: What a renderer does, in the order of the data: where two can be right or wrong for one reason.
STAGES = ("parsing", "camera", "intersection", "shading", "recursion")

#: Called with the fraction done (0…1); an exception that it raises ends the rendering.
Progress = Callable[[float], None]


@dataclass(frozen=True)
class Probe:
    """Whether a renderer works on this machine.

    `version` is empty where it is missing; `reason` says in a sentence why it does not work and
    `remedy` is the command that installs it.
    """

    available: bool
    version: str = ""
    reason: str = ""
    remedy: str = ""
    details: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class Capabilities:
    """The limits of a renderer (None: no limit of its own), and whose code it is.

    `stages` names who does each of `STAGES`, where that is not the renderer itself: two renderers
    with the same name there are one witness, not two. `bytes_per_pixel` is what rendering one takes
    at the peak, as measured, and `layer_bytes_per_pixel` what its layers take besides. `samples`
    says whether it takes a `sampling` other than a pixel's centre.
    """

    max_objects: int | None = None
    max_depth: int | None = None
    max_pixels: int | None = None
    bytes_per_pixel: int = 24
    layer_bytes_per_pixel: int = 0
    stages: Mapping[str, str] = field(default_factory=dict)
    samples: bool = False


@dataclass(frozen=True)
class RenderOptions:
    """How to render; picklable, part of an image's provenance.

    `threads` 0: all cores that this process may use. `readings` names another interpretation of the
    specification (`readings.py`); only `native` takes every one. `effects` None: what the scene
    calls for (`effects.py`). `timeout_s` bounds an external program; None: no bound. `layers` asks
    for the side outputs of a renderer that has them. With `tolerance` > 0 (only
    `native` takes one) secondary rays are left out that can hardly matter: no channel gets
    brighter, or darker by more than that. `sampling` says how a pixel is sampled (`sampling.py`);
    `tuning` sets what only this renderer has, by its own names.
    """

    threads: int = 0
    readings: Mapping[str, str] = field(default_factory=dict)
    precision: str = "f64"
    effects: frozenset[str] | None = None
    timeout_s: float | None = None
    layers: bool = False
    tolerance: float = 0.0
    sampling: Sampling = CENTRE
    tuning: Mapping[str, str] = field(default_factory=dict)


@dataclass
class Seconds:
    """Wall time of the stages of one rendering, in seconds.

    `startup` is what is paid apart from the image: imports and probing, by the first image of a
    process alone, and the start and end of an external program, by every image.
    """

    startup: float = 0.0
    translate: float = 0.0
    render: float = 0.0


#: What `settings["rays"]` of a rendering counts.
RAY_KINDS = ("primary", "shadow", "reflected", "refracted")


@dataclass
class Rendering:
    """An image and how it came about.

    `image` is linear RGB, (v_res, h_res, 3) float64, row 0 at the top, unclamped. `half_step` is
    the half width of the output's quantisation on that scale (0: none). `settings` is JSON-ready.
    `layers` are named arrays of (v_res, h_res, …).
    """

    image: NDArray[np.float64]
    seconds: Seconds
    half_step: float = 0.0
    settings: dict[str, Any] = field(default_factory=dict)
    layers: dict[str, NDArray[Any]] = field(default_factory=dict)
    messages: list[str] = field(default_factory=list)

    @property
    def n_rays(self) -> int | None:
        """All rays of the image by the renderer's own count; None where it does not say."""
        counted = self.settings.get("rays")
        return sum(counted[kind] for kind in RAY_KINDS) if counted else None


@dataclass(frozen=True)
class Translation:
    """A scene in another renderer's language: file name → text, the main one first."""

    files: Mapping[str, str]
    command: str


class Renderer(Protocol):
    """What a folder in `translators/` offers."""

    name: str
    capabilities: Capabilities

    def probe(self) -> Probe:
        """Say whether this renderer works here, without harming the calling process."""

    def ledger(self, scene: Scene) -> Ledger:
        """Say what of this scene is rendered otherwise than exactly, and with which arithmetic."""

    def render(
        self, scene: Scene, options: RenderOptions, progress: Progress | None = None
    ) -> Rendering:
        """Render, or raise RendererMissingError, UnsupportedSceneError or RendererError."""

    def translate(self, scene: Scene, options: RenderOptions) -> Translation:
        """Write the scene in the renderer's own language, or raise UnsupportedSceneError."""
