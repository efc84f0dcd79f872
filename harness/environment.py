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
        "packages": {name: package_version(name) for name in _PACKAGES},
        "system": _system(),
        "machine": platform.machine(),
        "cpu": _cpu(),
        "cores": available_cores(),
        "memory_mib": _memory_mib(),
    }


def _system() -> str:
    kernel = f"{platform.system()} {platform.release()}"
    try:
        return f"{platform.freedesktop_os_release()['PRETTY_NAME']}, {kernel}"
    except (OSError, KeyError):
        return kernel


def _cpu() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return platform.processor()
    names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.processor()


def _memory_mib() -> int | None:
    try:
        return os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") // 2**20
    except (OSError, ValueError, AttributeError):
        return None
