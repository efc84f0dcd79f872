"""The two Mitsuba lanes.

`mitsuba` is Mitsuba's own geometry in float32: its shapes, its ray queries, its ray offsets, with
this project's Phong material, falloff-free light, recursion and camera as plugins; the first
delivery uses nothing but Mitsuba. `mitsuba-f64` computes the specification in Dr.Jit Float64 with
the same shading, and has Mitsuba as its host.
"""

from __future__ import annotations

import time
from collections.abc import Collection
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crosstrace.translators import readings
from crosstrace.translators.effects import effects, needed
from crosstrace.translators.errors import RendererError, UsageError
from crosstrace.translators.ledger import Ledger
from crosstrace.translators.mitsuba import document, fidelity, first_delivery, runtime
from crosstrace.translators.mitsuba import probe as probing
from crosstrace.translators.mitsuba.elements import Element, to_dict
from crosstrace.translators.mitsuba.files import command, file_name, text
from crosstrace.translators.renderer import (
    Capabilities,
    Probe,
    Progress,
    Rendering,
    RenderOptions,
    Seconds,
    Translation,
)
from crosstrace.translators.sampling import only_centre
from crosstrace.translators.scene import Scene


class _Mitsuba:
    """What the lanes share; a subclass says which document, limits and image."""

    name: str
    capabilities: Capabilities
    magnitudes: tuple[float, float]
    precision: str

    def probe(self) -> Probe:
        """Say whether Mitsuba and its LLVM work here; the first call starts a child process."""
        return probing.probe()

    def document(self, scene: Scene, called_for: Collection[str]) -> list[Element]:
        """Return the scene in Mitsuba's plugins, for these effects."""
        raise NotImplementedError

    def picture(
        self, scene: Scene, loaded: Any, mi: Any, progress: Progress
    ) -> NDArray[np.float64]:
        """Render a loaded document to linear float64."""
        raise NotImplementedError

    def render(
        self, scene: Scene, options: RenderOptions, progress: Progress | None = None
    ) -> Rendering:
        """Render in this process; the limits and the meaning of errors are `Renderer`'s."""
        scene, called_for = self._reduced(scene, options)
        mi, startup = runtime.start(options.threads)
        begun = time.perf_counter()
        elements = self.document(scene, called_for)
        try:
            loaded = mi.load_dict(to_dict(elements, mi), parallel=False, optimize=False)
            translated = time.perf_counter()
            image = self.picture(scene, loaded, mi, progress or (lambda done: None))
        except RuntimeError as error:
            raise RendererError(f"{self.name}: {error}") from error
        seconds = Seconds(startup, translated - begun, time.perf_counter() - translated)
        settings = {
            "variant": runtime.VARIANT, "precision": self.precision,
            "integrator": elements[0].plugin, "camera": elements[1].plugin,
            "llvm": runtime.llvm_version(), "effects": sorted(called_for),
        } | self._settings()  # fmt: skip
        return Rendering(image, seconds, settings=settings)

    def translate(self, scene: Scene, options: RenderOptions) -> Translation:
        """Write the scene as one XML file, and the line that renders it."""
        elements = self.document(*self._reduced(scene, options))
        file = file_name(scene.name)
        return Translation({file: text(elements)}, command(elements, file))

    def _reduced(self, scene: Scene, options: RenderOptions) -> tuple[Scene, frozenset[str]]:
        """Return what of a scene is to be translated, and which effects are."""
        readings.only_default(options.readings, self.name, options.tolerance)
        only_centre(options.sampling, self.name)
        if options.tuning:
            raise UsageError(
                f"{self.name} has no settings of its own, found {', '.join(options.tuning)}"
            )
        if options.effects is None:
            found = effects(scene)
            reduced, called_for = needed(scene, found), frozenset(found.names)
        else:
            reduced, called_for = scene, frozenset(options.effects)
        fidelity.refuse(self.name, reduced, called_for, self.capabilities, self.magnitudes)
        return reduced, called_for

    def _settings(self) -> dict[str, Any]:
        return {}


class MitsubaStock(_Mitsuba):
    """Float32 through Mitsuba's shapes and ray queries; wholly stock for the first delivery."""

    name = "mitsuba"
    capabilities = Capabilities(10_000, fidelity.DEEPEST, 2**25, 64, stages=fidelity.SHARED)
    magnitudes = fidelity.FLOAT32_RANGE
    precision = "float32"

    def ledger(self, scene: Scene) -> Ledger:
        """Say what Mitsuba does by its own rules, and what float32 costs."""
        return fidelity.ledger_f32(scene, effects(scene).names)

    def document(self, scene: Scene, called_for: Collection[str]) -> list[Element]:
        """Return the stock document where it says everything."""
        if document.is_stock(scene, called_for):
            return document.stock(scene)
        return document.single(scene, called_for)

    def picture(
        self, scene: Scene, loaded: Any, mi: Any, progress: Progress
    ) -> NDArray[np.float64]:
        """Render through film and sampler, as Mitsuba does: in one piece."""
        rendered = loaded.integrator().render(loaded)
        progress(1.0)
        if np.asarray(rendered).shape[2] == 4:
            return first_delivery.image(scene, rendered, loaded, mi)
        return np.array(rendered, np.float64)

    def _settings(self) -> dict[str, Any]:
        return {"near": document.NEAR, "disk": document.DISK, "offset": "mitsuba"}


class MitsubaExact(_Mitsuba):
    """Float64 throughout; scans all objects for each ray, so their number is limited."""

    name = "mitsuba-f64"
    capabilities = Capabilities(
        fidelity.MOST_OBJECTS_EXACT, fidelity.DEEPEST, 2**27, 48, stages=fidelity.SHARED
    )
    magnitudes = fidelity.FLOAT64_RANGE
    precision = "float64"

    def ledger(self, scene: Scene) -> Ledger:
        """Say that only rounding is left."""
        return fidelity.ledger_f64(scene)

    def document(self, scene: Scene, called_for: Collection[str]) -> list[Element]:
        """Return the document of our plugins alone."""
        return document.double(scene, called_for)

    def picture(
        self, scene: Scene, loaded: Any, mi: Any, progress: Progress
    ) -> NDArray[np.float64]:
        """Render past the film, which is float32."""
        integrator = loaded.integrator()
        integrator.progress = progress
        integrator.render(loaded)
        image: NDArray[np.float64] = integrator.image64
        return image

    def _settings(self) -> dict[str, Any]:
        return {"epsilon": 1e-5}
