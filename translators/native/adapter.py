"""The native lane: the C reference tracer of this project, in double unless asked otherwise."""

from __future__ import annotations

import time
from collections.abc import Iterator
from typing import Any

import numpy as np

from crosstrace.native import _core
from crosstrace.translators import readings as readings_of_the_specification
from crosstrace.translators.effects import effects, mask
from crosstrace.translators.errors import RendererError, UnsupportedSceneError, UsageError
from crosstrace.translators.ledger import Arithmetic, Entry, Ledger
from crosstrace.translators.native.samples import sampled
from crosstrace.translators.renderer import (
    Capabilities,
    Probe,
    Progress,
    Rendering,
    RenderOptions,
    Seconds,
    Translation,
)
from crosstrace.translators.sampling import CENTRE
from crosstrace.translators.scene import Scene

#: The terms of `contributions`, in order: they add up to the image.
CONTRIBUTIONS = ("base", "diffuse", "specular", "reflection", "refraction", "total_reflection")


LARGEST_TOLERANCE = 1e100

#: The scalar types of the tracer, narrowest first; a platform may lack f80 or f128.
PRECISIONS = {
    "f32": "float, 2^-24",
    "f64": "double, 2^-53",
    "f64c": "double with compensated intersection, refraction and highlight, 2^-53",
    "f80": "x87 long double, 2^-64",
    "dd": "double-double, 2^-104",
    "f128": "float128, 2^-113",
}

#: Half the distance from 1 to the next number: the relative error of one operation.
UNITS = {"f32": 2.0**-24, "f64": 2.0**-53, "f64c": 2.0**-53, "f80": 2.0**-64, "dd": 2.0**-104,
         "f128": 2.0**-113}  # fmt: skip


def present() -> list[str]:
    """Return the precisions of this platform, narrowest first."""
    return _core.precisions()


def check_precision(precision: str) -> None:
    """Raise UsageError for a precision that this platform does not have."""
    if precision not in (present := _core.precisions()):
        raise UsageError(f"precision: expected one of {', '.join(present)}, found {precision!r}")


def check_tolerance(tolerance: float) -> None:
    """Raise UsageError for what is no tolerance."""
    if not 0 <= tolerance <= LARGEST_TOLERANCE:
        raise UsageError(f"tolerance: expected a number from 0 to 1e100, found {tolerance!r}")


#: What the native library was compiled with.
COMPILER = _core.compiler


#: Units that directions and hits carry, measured. Suspect and wrong pixels of honest float32 images
#: (harness/tests/test_kappa.py has some of this):
#:
#: | of | κ = 1/4 | 1/2 | 1 | 2 | 3 | 4 | 8 |
#: |---|---|---|---|---|---|---|---|
#: | 16,049 that differ in 18 course scenes (120 x 160) | 914 | 381 | 2 | 0 | 0 | 0 | 0 |
#: | 18,422 that differ in 28 hard scenes | 2437 | 811 | 175 | 109 | 84 | 75 | 344 |
#:
#: From 1 on those of hard scenes are ground-1e6's, but for 287 of far-tiny under 8.
KAPPA = 2.0


def arithmetic(precision: str) -> Arithmetic:
    """Return the rounding errors of a precision."""
    return Arithmetic(UNITS[precision], KAPPA, UNITS[precision])


#: Of the default precision.
ARITHMETIC = arithmetic("f64")


#: Of a band, where an image is rendered in bands; a multiple of whole rows at least.
BAND_PIXELS = 2**22


class Native:
    """The C11 tracer: Whitted's algorithm, every reading and precision, side outputs on request."""

    name = "native"
    capabilities = Capabilities(
        max_pixels=2**29, layer_bytes_per_pixel=216, stages={"parsing": "crosstrace"}, samples=True
    )

    def probe(self) -> Probe:
        """Report the library that this package was built with."""
        present = _core.precisions()
        absent = [name for name in PRECISIONS if name not in present]
        details = {"precisions": " ".join(present)}
        if absent:
            details["absent precisions"] = " ".join(absent)
        return Probe(True, _core.version, details=details)

    def ledger(self, scene: Scene) -> Ledger:
        """Declare the arithmetic, the only thing that is not exact."""
        bound = (
            "double arithmetic by default, relative error a few units of 2^-53 for each operation; "
            f"other precisions: {', '.join(_core.precisions())}"
        )
        return Ledger((Entry("arithmetic", bound, "approximated"),), ARITHMETIC)

    def translate(self, scene: Scene, options: RenderOptions) -> Translation:
        """Write the scene in the course's format, which is the native tracer's own."""
        from crosstrace.translators.course import dumps

        return Translation({"scene.txt": dumps(scene)}, "crosstrace render scene.txt -o scene.png")

    def render(
        self, scene: Scene, options: RenderOptions, progress: Progress | None = None
    ) -> Rendering:
        """Render in threads; `options.layers` adds object, t, normal, tree, rays, contributions.

        Precisions wider than double add `image_low`, what rounding the image to double left out.
        Raises UsageError for a reading or precision that does not exist, RendererError where the
        ray budget is used up, UnsupportedSceneError for an image beyond memory, and lets
        KeyboardInterrupt through within a fraction of a second.
        """
        n_pixels = scene.v_res * scene.h_res
        if n_pixels > (self.capabilities.max_pixels or n_pixels):
            raise UnsupportedSceneError(f"native: {n_pixels} pixels are more than one image holds")
        return _render(scene, options, 0, scene.v_res, progress)

    def bands(
        self, scene: Scene, options: RenderOptions, progress: Progress | None = None
    ) -> Iterator[Rendering]:
        """Render an image of any size in bands of rows, from the top; the pixels are `render`'s.

        What is held at a time is a band of `BAND_PIXELS`, 24 bytes each. Raises as `render`.
        """
        height = max(1, BAND_PIXELS // scene.h_res)
        tree = _core.tree(scene.native_view(), progress)
        for begin in range(0, scene.v_res, height):
            end = min(scene.v_res, begin + height)

            def told(share: float, begin: int = begin, end: int = end) -> None:
                if progress is not None:
                    progress((begin + share * (end - begin)) / scene.v_res)

            yield _render(scene, options, begin, end, told, tree)


def _render(
    scene: Scene,
    options: RenderOptions,
    begin: int,
    end: int,
    progress: Progress | None,
    tree: Any = None,
) -> Rendering:
    readings_of_the_specification.check(options.readings)
    check_precision(options.precision)
    check_tolerance(options.tolerance)
    is_sampled = options.sampling != CENTRE
    if is_sampled and options.layers:
        raise UsageError(f"side outputs are of a pixel's centre, found {options.sampling}")
    if options.tuning:
        raise UsageError(f"native has readings alone, found {', '.join(options.tuning)}")
    started = time.perf_counter()
    called_for = options.effects
    wanted = effects(scene, options.readings).overall if called_for is None else mask(called_for)
    outputs = {} if is_sampled else _outputs(end - begin, scene.h_res, options)
    settings = [*options.readings.items(), ("precision", options.precision),
                ("threads", str(options.threads)), ("effects", str(wanted)),
                ("tolerance", repr(float(options.tolerance)))]  # fmt: skip
    translated = time.perf_counter()
    try:
        if is_sampled:
            outputs["image"], rays = sampled(scene, settings, options.sampling, progress)
        else:
            span = [("row_begin", str(begin)), ("row_end", str(end))]
            rays = _core.render(scene.native_view(), settings + span, outputs, progress, tree)
    except (RuntimeError, ValueError) as error:
        raise RendererError(f"native: {error}") from None
    seconds = Seconds(0.0, translated - started, time.perf_counter() - translated)
    record: dict[str, Any] = {"precision": options.precision, "rays": rays,
                              "readings": dict(options.readings)}  # fmt: skip
    if options.tolerance:
        record["tolerance"] = options.tolerance
    if is_sampled:
        record["sampling"] = str(options.sampling)
    image = outputs.pop("image")
    return Rendering(image, seconds, settings=record, layers=outputs)


def _outputs(rows: int, columns: int, options: RenderOptions) -> dict[str, Any]:
    outputs: dict[str, Any] = {"image": np.empty((rows, columns, 3))}
    if options.layers:
        outputs |= {
            "object": np.empty((rows, columns), np.int32),
            "t": np.empty((rows, columns)),
            "normal": np.empty((rows, columns, 3)),
            "tree": np.empty((rows, columns), np.uint64),
            "rays": np.empty((rows, columns), np.uint32),
            "contributions": np.empty((rows, columns, len(CONTRIBUTIONS), 3)),
        }
        if options.precision in ("f80", "dd", "f128"):
            outputs["image_low"] = np.empty((rows, columns, 3))
    return outputs
