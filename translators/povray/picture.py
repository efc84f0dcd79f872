"""Everything that is worked out about a scene before its text is written, and that text."""

from __future__ import annotations

import re
from dataclasses import dataclass

from crosstrace.translators.povray.camera import CameraSide, camera_side
from crosstrace.translators.povray.lights import Lighting, lighting
from crosstrace.translators.povray.media import Media, media
from crosstrace.translators.povray.output import safe_scale
from crosstrace.translators.povray.plan import MAX_DEPTH, Plan, plan
from crosstrace.translators.povray.scale import value_bound, world_scale
from crosstrace.translators.povray.sdl import Writer
from crosstrace.translators.scene import Scene

#: Linear 16-bit samples, one ray through each pixel's centre, no dithering, no window, no pause.
_SWITCHES = "-A -J -D -P -TH -GD -GR -GS +MB3 File_Gamma=1.0"


@dataclass(frozen=True)
class Analysis:
    """A plan and what follows from it.

    `scale` is the world scale and `bound` a number that no pixel exceeds.
    """

    plan: Plan
    side: CameraSide
    lighting: Lighting
    media: Media
    scale: float
    bound: float

    def text(self, output_scale: float) -> str:
        """Return the scene in POV-Ray's language."""
        writer = Writer(self.plan, self.side, self.media, self.lighting, self.scale)
        return writer.text(output_scale)


def analyse(scene: Scene, requested: frozenset[str] | None = None) -> Analysis:
    """Analyse a scene for POV-Ray; raises UnsupportedSceneError where it cannot be expressed."""
    reduced = plan(scene, requested)
    scale = world_scale(reduced)
    side = camera_side(reduced, scale)
    lit = lighting(reduced, side)
    bound = value_bound(reduced, lit)
    return Analysis(reduced, side, lit, media(reduced, side), scale, bound)


def arguments(plan: Plan, source: str, image: str, kind: str, threads: str = "") -> list[str]:
    """Return the command line's arguments; `kind` is POV-Ray's letter of a file format."""
    size = [f"+W{plan.scene.h_res}", f"+H{plan.scene.v_res}", f"+Q{plan.quality}"]
    more = [f"+WT{threads}"] if threads else []
    return [f"+I{source}", f"+O{image}", f"+F{kind}16", *size, *_SWITCHES.split(), *more]


def file_name(name: str) -> str:
    """Return a scene's name as a file name that means nothing to a shell or to POV-Ray."""
    return re.sub(r"[^A-Za-z0-9_]+", "-", name).strip("-")[:80] or "scene"


def comment(analysis: Analysis, command: str, output_scale: float) -> str:
    """Return the lines on top of a description that say how to call POV-Ray for it."""
    lines = [
        f"// {command}",
        f"// The image is linear (gamma 1); multiply it by output_scale = {output_scale!r}.",
        "// Declare=output_scale=X on the command line sets another scale, of six digits at most.",
        "// The smallest at which nothing saturates is the most precise: half a step of a sample",
        "// is output_scale/131070.",
    ]
    if output_scale < safe_scale(analysis.bound):
        lines.append("// Values beyond output_scale are cut; the scene does not rule them out.")
    if analysis.plan.deep:
        lines.append(
            f"// The scene asks for more than {MAX_DEPTH} bounces. POV-Ray traces no more; add +GS "
            "and see that"
        )
        lines.append(f"// the Max Level that it states stays below {MAX_DEPTH + 1}.")
    return "\n".join(lines) + "\n"
