"""Mitsuba inside this process: imported once, with its variant, our plugins and a thread count."""

from __future__ import annotations

import os
import time
from typing import Any

from crosstrace.translators.errors import RendererMissingError
from crosstrace.translators.mitsuba.probe import (
    LLVM_REMEDY,
    MITSUBA_REMEDY,
    refuse_bad_llvm,
)

VARIANT = "llvm_ad_rgb"


class _Once:
    """The module `mitsuba` with its variant set, once it has been started."""

    mi: Any = None


def start(threads: int) -> tuple[Any, float]:
    """Return the module `mitsuba` and the seconds that it took to get it ready, 0 after the first.

    `threads` 0: as many as this process may use. Raises RendererMissingError.
    """
    begun = time.perf_counter()
    seconds = 0.0
    if _Once.mi is None:
        _Once.mi = _import()
        seconds = time.perf_counter() - begun
    if _Once.mi.variant() != VARIANT:
        _Once.mi.set_variant(VARIANT)
    import drjit as dr

    dr.set_thread_count(threads or len(os.sched_getaffinity(0)))
    return _Once.mi, seconds


def llvm_version() -> str:
    """Return the version of the LLVM library in use; only after `start`."""
    import drjit as dr

    return ".".join(map(str, dr.detail.llvm_version()))


def _import() -> Any:
    try:
        import drjit as dr
        import mitsuba as mi
    except ImportError as error:
        raise RendererMissingError(f"Mitsuba cannot be imported: {error}", MITSUBA_REMEDY) from None
    try:
        mi.set_variant(VARIANT)
    except ImportError as error:
        raise RendererMissingError(f"Mitsuba finds no LLVM: {error}", LLVM_REMEDY) from None
    refuse_bad_llvm(dr.detail.llvm_version())
    mi.set_log_level(mi.LogLevel.Error)
    import crosstrace.translators.mitsuba.plugins  # noqa: F401 (registers them)

    return mi
