"""Faults for self-tests, by name: what a renderer does wrong, planted in a lane on purpose."""

from __future__ import annotations

from crosstrace.harness.faults.apart import render_here, render_with
from crosstrace.harness.faults.catalogue import FAULTS, fault, plantings
from crosstrace.harness.faults.changes import changed_pixels, noise
from crosstrace.harness.faults.fault import Fault

__all__ = [
    "FAULTS",
    "Fault",
    "changed_pixels",
    "fault",
    "noise",
    "plantings",
    "render_here",
    "render_with",
]
