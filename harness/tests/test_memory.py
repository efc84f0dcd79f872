"""Peak memory: of this job, with the programs that it started."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from crosstrace.harness.jobs import WorkerPool
from crosstrace.harness.memory import PeakMemory

HUNDRED_MIB = 100 * 2**20

pytestmark = pytest.mark.skipif(
    not Path("/proc/self/clear_refs").exists(), reason="the peak can be reset on Linux only"
)


def measured(n_bytes: int, child_bytes: int) -> float:
    """Touch memory here and in a child program; return the peak in MiB (runs in a worker)."""
    with PeakMemory() as memory:
        held = np.ones(n_bytes, np.uint8)
        if child_bytes:
            script = f"import time; held = b'x' * {child_bytes}; time.sleep(0.3)"
            subprocess.run([sys.executable, "-c", script], check=True)
        del held
    return memory.mib


def test_a_job_reports_its_own_peak_and_not_the_heaviest_so_far(pool: WorkerPool) -> None:
    """The worker is the same, its earlier job took a hundred MiB more."""
    import test_memory as here

    heavy = pool.submit(here.measured, HUNDRED_MIB, 0).result()
    light = pool.submit(here.measured, 1, 0).result()
    assert 90 < heavy - light < 110


def test_a_program_that_a_job_starts_counts(pool: WorkerPool) -> None:
    """As POV-Ray does for its lane."""
    import test_memory as here

    alone = pool.submit(here.measured, 1, 0).result()
    with_child = pool.submit(here.measured, 1, HUNDRED_MIB).result()
    assert with_child - alone > 95
