"""Renderers for the tests: each misbehaves in one way, and none needs anything installed."""

from __future__ import annotations

import os
import signal
import time
from pathlib import Path
from typing import Any

import numpy as np

from crosstrace.translators.errors import RendererMissingError, UnsupportedSceneError
from crosstrace.translators.ledger import Arithmetic, Entry, Ledger
from crosstrace.translators.renderer import (
    Capabilities,
    Probe,
    Progress,
    Rendering,
    RenderOptions,
    Seconds,
    Translation,
)
from crosstrace.translators.scene import Scene


class Gradient:
    """Paints a ramp that depends on the scene's size alone."""

    name = "gradient"
    capabilities = Capabilities(max_objects=1000)
    gain = 1.0

    def probe(self) -> Probe:
        """Work everywhere."""
        return Probe(True, "1.0-test")

    def ledger(self, scene: Scene) -> Ledger:
        """Declare one thing."""
        entry = Entry("geometry", "there is none <b>at all</b>", "unsupported", None, (0, 1))
        return Ledger((entry,), Arithmetic(2.0**-53, 1.0, 2.0**-53))

    def render(
        self, scene: Scene, options: RenderOptions, progress: Progress | None = None
    ) -> Rendering:
        """Paint."""
        print("a library that prints to standard output")
        rows, columns = scene.v_res, scene.h_res
        image = np.zeros(scene.shape)
        image[..., 0] = np.linspace(0, 1, rows)[:, None]
        image[..., 1] = np.linspace(0, 1, columns)[None, :]
        if progress is not None:
            progress(0.5)
        settings: dict[str, Any] = {"threads": options.threads, "pid": os.getpid()}
        layers = {"object": np.zeros((rows, columns), np.int32)} if options.layers else {}
        return Rendering(
            self.gain * image, Seconds(0.25, 0.125, 0.5), settings=settings, layers=layers
        )

    def translate(self, scene: Scene, options: RenderOptions) -> Translation:
        """Write two files."""
        files = {"main.fake": "the scene\n", "../part.fake": "a part\n"}
        return Translation(files, "fake main.fake")


class Plain(Gradient):
    """Is right about scenes without an object."""

    def render(
        self, scene: Scene, options: RenderOptions, progress: Progress | None = None
    ) -> Rendering:
        """Paint the background."""
        made = super().render(scene, options, progress)
        made.image[:] = scene.background / 255
        return made


class Brighter(Gradient):
    """Is one per cent too bright."""

    gain = 1.01


class Absent(Gradient):
    """Is not installed."""

    def probe(self) -> Probe:
        """Say what is missing."""
        return Probe(False, reason="no such program <script>", remedy="apt-get install it")

    def render(
        self, scene: Scene, options: RenderOptions, progress: Progress | None = None
    ) -> Rendering:
        """Raise."""
        raise RendererMissingError("no such program <script>", "apt-get install it")


class Refusing(Gradient):
    """Cannot express any scene."""

    def render(
        self, scene: Scene, options: RenderOptions, progress: Progress | None = None
    ) -> Rendering:
        """Raise."""
        raise UnsupportedSceneError("no scene at all")


class Crashing(Gradient):
    """Takes its process down."""

    def render(
        self, scene: Scene, options: RenderOptions, progress: Progress | None = None
    ) -> Rendering:
        """Die as a bad pointer would make it."""
        os.kill(os.getpid(), signal.SIGSEGV)
        raise AssertionError("unreachable")


class Hanging(Gradient):
    """Never ends."""

    def render(
        self, scene: Scene, options: RenderOptions, progress: Progress | None = None
    ) -> Rendering:
        """Sleep."""
        while True:
            time.sleep(1)


class Wrongly(Gradient):
    """Returns an image of another size."""

    def render(
        self, scene: Scene, options: RenderOptions, progress: Progress | None = None
    ) -> Rendering:
        """Paint too little."""
        return Rendering(np.zeros((1, 1, 3)), Seconds())


class Undefined(Gradient):
    """Has a pixel that is not a number."""

    def render(
        self, scene: Scene, options: RenderOptions, progress: Progress | None = None
    ) -> Rendering:
        """Paint, with a hole."""
        made = super().render(scene, options, progress)
        made.image[0, 0, 0] = np.nan
        return made


class Moody(Plain):
    """Is right about scenes without an object, but for what a file tells it to add.

    ``CROSSTRACE_TEST_MOOD`` names the file; it holds a number and the count of pixels that get it.
    """

    def render(
        self, scene: Scene, options: RenderOptions, progress: Progress | None = None
    ) -> Rendering:
        """Paint the background and what is to be added."""
        made = super().render(scene, options, progress)
        number, n_pixels = Path(os.environ["CROSSTRACE_TEST_MOOD"]).read_text().split()
        made.image.reshape(-1, 3)[: int(n_pixels)] += float(number)
        return made


class Forgetful(Gradient):
    """Draws another picture where it is left to choose the effects itself."""

    def render(
        self, scene: Scene, options: RenderOptions, progress: Progress | None = None
    ) -> Rendering:
        """Paint, a little brighter with all effects."""
        made = super().render(scene, options, progress)
        if options.effects is not None and len(options.effects) > 6:
            made.image = made.image + 2.0**-40
        return made
