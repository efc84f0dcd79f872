"""A document as a file that plain Mitsuba opens, and the line of shell that renders it.

The line writes the image next to the scene file: an OpenEXR file in float32, and for the exact lane
an array of float64 as well.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import PurePath

from crosstrace.translators.mitsuba.elements import Element, to_xml

_OURS = "crosstrace_"
_PLUGINS = "import crosstrace.translators.mitsuba.plugins"


def file_name(scene_name: str) -> str:
    """Return a file name for a scene, of letters, digits, dots, hyphens and underscores only."""
    return (re.sub(r"[^A-Za-z0-9._-]", "_", scene_name).strip(".") or "scene") + ".xml"


def text(elements: Sequence[Element]) -> str:
    """Return the XML of a document, with what it needs said in its first comment."""
    if _ours(elements):
        note = f"Needs the plugins of crosstrace: {_PLUGINS} after mitsuba.set_variant"
    else:
        note = "Stock Mitsuba 3; the channels color.R, color.G, color.B are the image"
    return to_xml(elements, note)


def command(elements: Sequence[Element], file: str) -> str:
    """Return the line that renders `file`, a name of `file_name`."""
    stem = PurePath(file).stem
    steps = ["import mitsuba as mi", "mi.set_variant('llvm_ad_rgb')"]
    if _ours(elements):
        steps.append(_PLUGINS)
    steps.append(f"scene = mi.load_file('{file}', parallel=False, optimize=False)")
    steps.append("image = mi.render(scene)")
    if not _ours(elements):
        steps.append("image = image[:, :, :3]")
    steps.append(f"mi.Bitmap(image).write('{stem}.exr')")
    if elements[0].plugin.endswith("_f64"):
        steps.append(f"import numpy; numpy.save('{stem}.npy', scene.integrator().image64)")
    return f'python -c "{"; ".join(steps)}"'


def _ours(elements: Sequence[Element]) -> bool:
    return any(element.plugin.startswith(_OURS) for element in elements)
