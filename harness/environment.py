"""What a result depends on besides the scene: versions and machine, without names or paths."""

from __future__ import annotations

import os
import platform
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

from crosstrace.harness.jobs import available_cores

#: Packages whose version can change a result or a picture.
_PACKAGES = ("numpy", "mitsuba", "drjit", "OpenImageIO", "scikit-image", "scipy", "jinja2")

#: Instructions for which Mitsuba's kernels are compiled where they are there.
_FEATURES = ("fma", "avx2", "avx512f")


def package_version(name: str = "crosstrace") -> str:
    """Return an installed distribution's version, or an empty text."""
    try:
        return version(name)
    except PackageNotFoundError:
        return ""


def describe() -> dict[str, Any]:
    """Return the environment of a report, JSON-ready."""
    return {
        "crosstrace": package_version(),
        "python": platform.python_version(),
        "compiler": _compiler(),
        "packages": {name: package_version(name) for name in _PACKAGES},
        "system": _system(),
        "machine": platform.machine(),
        "cpu": _cpu(),
        "cpu_features": _cpu_features(),
        "cores": available_cores(),
        "memory_mib": _memory_mib(),
    }


def _compiler() -> str:
    """Return the compiler of the native tracer, as in ``gcc 12.2.0``."""
    from crosstrace.translators.native.adapter import COMPILER

    return COMPILER


def _system() -> str:
    kernel = f"{platform.system()} {platform.release()}"
    try:
        return f"{platform.freedesktop_os_release()['PRETTY_NAME']}, {kernel}"
    except (OSError, KeyError):
        return kernel


def _cpu() -> str:
    return _cpuinfo("model name") or platform.processor()


def _cpu_features() -> list[str]:
    """Return which of the instructions are there by which float32 results differ."""
    present = _cpuinfo("flags").split()
    return [name for name in _FEATURES if name in present]


def _cpuinfo(key: str) -> str:
    """Return what Linux says of the first processor, or an empty text."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return ""
    found = [line.partition(":")[2].strip() for line in lines if line.startswith(key)]
    return found[0] if found else ""


def _memory_mib() -> int | None:
    try:
        return os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") // 2**20
    except (OSError, ValueError, AttributeError):
        return None
