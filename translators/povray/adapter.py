"""The lane `povray`: POV-Ray 3.7 as an independent renderer of the course's scenes.

POV-Ray intersects in double, keeps colours in float32 and shades by itself; nothing of ours is in
its path but the description that it reads. `sdl.py` says how each surface is written, `media.py`
how nested glass is, `lights.py` how the specification's normals are, `scale.py` and `output.py` how
its tolerances and its output are dealt with, `declarations.py` what is left.
"""

from __future__ import annotations

import contextlib
import os
import tempfile
import time
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

from crosstrace.translators.errors import (
    RendererError,
    RendererMissingError,
    UnsupportedSceneError,
)
from crosstrace.translators.ledger import Ledger
from crosstrace.translators.leftovers import sweep
from crosstrace.translators.povray import declarations, output, picture, process, tuning
from crosstrace.translators.povray.plan import MAX_DEPTH
from crosstrace.translators.readings import only_default
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

#: POV-Ray's own limit (`configbackend.h`).
_MAX_THREADS = 512

_PREFIX = "crosstrace-povray-"


class PovRay:
    """POV-Ray as a child process; satisfies the protocol `Renderer`."""

    name = "povray"
    #: No max_depth: how deep the rays of a scene get, and what they carry, shows in rendering it.
    capabilities = Capabilities(
        max_objects=1_000_000, bytes_per_pixel=64, stages={"parsing": "crosstrace"}
    )

    def probe(self) -> Probe:
        """Find the program and ask for its version."""
        try:
            program = process.find_program()
            with _private_directory() as directory:
                version = process.find_version(program, directory)
        except RendererMissingError as error:
            return Probe(False, reason=error.reason, remedy=error.remedy)
        except RendererError as error:
            return Probe(False, reason=str(error))
        if not version.startswith("3.7"):
            reason = f"expected POV-Ray 3.7, found {version}"
            return Probe(False, version, reason, process.REMEDY, {"program": str(program)})
        return Probe(True, version, details={"program": str(program)})

    def ledger(self, scene: Scene) -> Ledger:
        """List what of a scene is not exact; raises UnsupportedSceneError where nothing is."""
        return declarations.declare(picture.analyse(scene))

    def text(self, analysis: picture.Analysis, output_scale: float) -> str:
        """Return the description that POV-Ray reads; what it holds is all that POV-Ray knows."""
        return analysis.text(output_scale)

    def render(
        self, scene: Scene, options: RenderOptions, progress: Progress | None = None
    ) -> Rendering:
        """Render a scene; see the protocol for what is raised."""
        only_default(options.readings, self.name, options.tolerance)
        only_centre(options.sampling, self.name)
        tuned = tuning.read(options.tuning)
        program = process.find_program()
        started = time.perf_counter()
        analysis = picture.analyse(scene, options.effects)
        threads = min(options.threads or len(os.sched_getaffinity(0)), _MAX_THREADS)
        messages: list[str] = []
        passes: list[float] = []
        rays: Counter[str] = Counter()
        traced_s: list[float | None] = []
        with _private_directory() as directory:
            source, image = directory / "scene.pov", directory / "image.ppm"
            source.write_text(self.text(analysis, 1.0), encoding="ascii")
            translated = time.perf_counter()
            since = time.monotonic()

            def render_at(scale: float) -> output.Picture:
                image.unlink(missing_ok=True)
                call = picture.arguments(analysis.plan, source.name, image.name, "P", str(threads))
                call += ["+V", f"Declare=output_scale={scale!r}"]
                call += [*tuned.switches, "+GS"]
                share = output.shared(progress, analysis.bound, len(passes))
                passes.append(scale)
                said = process.run(program, call, directory, options.timeout_s, share, since)
                messages.extend(w for w in process.warnings(said) if w not in messages)
                rays.update(process.rays(said))
                traced_s.append(process.trace_seconds(said))
                if analysis.plan.deep and process.exhausted(said):
                    raise UnsupportedSceneError(
                        f"POV-Ray traces at most max_depth {MAX_DEPTH}, found {scene.max_depth} "
                        "and rays that get there"
                    )
                return output.read_ppm(image, scene.v_res, scene.h_res)

            made = output.render_scaled(render_at, analysis.bound, tuned.output_scale)
            if progress is not None:
                progress(1.0)
        taken = time.perf_counter() - translated
        # The program starts, waits for its own polls and ends again for every image.
        known = [seconds for seconds in traced_s if seconds is not None]
        traced = min(taken, sum(known)) if len(known) == len(traced_s) else taken
        return Rendering(
            image=made.image,
            seconds=Seconds(taken - traced, translated - started, traced),
            half_step=made.half_step,
            settings={
                **({"rays": dict(rays)} if rays else {}),
                **({"tuning": dict(options.tuning)} if options.tuning else {}),
                "version": made.version,
                "threads": threads,
                "world_scale": analysis.scale,
                "output_scale": made.scale,
                "output_scales": list(made.passes),
                "max_trace_level": analysis.plan.depth + 1,
                "quality": analysis.plan.quality,
            },
            messages=messages,
        )

    def translate(self, scene: Scene, options: RenderOptions) -> Translation:
        """Write a scene description with a comment saying how to call plain `povray` for it."""
        only_default(options.readings, self.name, options.tolerance)
        analysis = picture.analyse(scene, options.effects)
        name = picture.file_name(scene.name)
        scale = output.written_scale(analysis.bound)
        arguments = picture.arguments(analysis.plan, f"{name}.pov", f"{name}.png", "N")
        command = " ".join(["povray", *arguments])
        said = picture.comment(analysis, command, scale)
        return Translation({f"{name}.pov": said + self.text(analysis, scale)}, command)


@contextlib.contextmanager
def _private_directory() -> Iterator[Path]:
    made = tempfile.TemporaryDirectory
    try:
        sweep(Path(tempfile.gettempdir()), _PREFIX)
        with made(prefix=_PREFIX, ignore_cleanup_errors=True) as name:
            yield Path(name)
    except OSError as error:
        raise RendererError(f"povray's files cannot be kept: {error}") from error
