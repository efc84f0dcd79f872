"""Whether Mitsuba works here, found out without harm to the calling process.

Mitsuba finds its compiler, LLVM, when a variant is set. Without one, or with 14 and older, that
raises ImportError; 15 and 16 load and then abort the process at the first kernel that takes a
maximum. So `probe` lets a child process compile such a kernel, and `refuse_bad_llvm`, for a process
that is about to render, only looks at the version.
"""

from __future__ import annotations

import functools
import importlib.util
import json
import subprocess
import sys
from collections.abc import Sequence

from crosstrace.translators.errors import RendererMissingError
from crosstrace.translators.renderer import Probe

LLVM_REMEDY = "apt-get install libllvm19"
MITSUBA_REMEDY = "python -m pip install 'mitsuba>=3.9.1,<3.10'"

#: The first major version of LLVM whose x86 back end knows a floating-point maximum.
OLDEST_LLVM = 17

CHILD_LIMIT_S = 60.0

_CHILD = """
import json, mitsuba as mi, drjit as dr
mi.set_variant("llvm_ad_rgb")
good = dr.all(dr.maximum(mi.Float([1, 2]), 1.5) == mi.Float([1.5, 2]))
good &= dr.all(mi.Float64([1, 2]) / 4 == mi.Float64([0.25, 0.5]))
llvm = ".".join(map(str, dr.detail.llvm_version()))
found = {"good": bool(good), "mitsuba": mi.__version__, "drjit": dr.__version__, "llvm": llvm}
print(json.dumps(found))
"""


@functools.cache
def probe() -> Probe:
    """Compile a small kernel in a child process, once in the life of this one."""
    if importlib.util.find_spec("mitsuba") is None:
        return Probe(False, reason="the package mitsuba is not installed", remedy=MITSUBA_REMEDY)
    try:
        done = subprocess.run(
            [sys.executable, "-c", _CHILD],
            capture_output=True, text=True, timeout=CHILD_LIMIT_S, check=False,
        )  # fmt: skip
    except (OSError, subprocess.TimeoutExpired) as error:
        return Probe(False, reason=f"Mitsuba could not be tried: {error}")
    if done.returncode != 0:
        return _failed(done.returncode, done.stderr)
    found = json.loads(done.stdout.splitlines()[-1])
    if not found.pop("good"):
        return Probe(False, reason="Dr.Jit computes wrong numbers here", remedy=LLVM_REMEDY)
    return Probe(True, found["mitsuba"], details={name: found[name] for name in ("drjit", "llvm")})


def _failed(status: int, stderr: str) -> Probe:
    if status < 0:
        reason = "the LLVM library found here aborts the process (versions 15 and 16 do)"
        return Probe(False, reason=f"{reason}: signal {-status}", remedy=LLVM_REMEDY)
    last = stderr.strip().splitlines()[-1] if stderr.strip() else f"exit status {status}"
    if "LLVM" in stderr:
        reason = "Mitsuba needs LLVM 17 or newer and found none that it can use"
        return Probe(False, reason=reason, remedy=LLVM_REMEDY, details={"error": last})
    return Probe(False, reason=f"Mitsuba cannot be imported: {last}", remedy=MITSUBA_REMEDY)


def refuse_bad_llvm(version: Sequence[int]) -> None:
    """Raise RendererMissingError for an LLVM that would abort the calling process."""
    if version[0] < OLDEST_LLVM:
        found = ".".join(map(str, version))
        raise RendererMissingError(f"LLVM {found} aborts on Mitsuba's kernels", LLVM_REMEDY)
