"""The greatest memory of a job: of its process and of the programs that it started.

The kernel's own high-water mark is reset before the job, so that a warm worker reports this job and
not the heaviest so far. Programs that the job starts (POV-Ray) are watched while they run; their
greatest sizes are added to the process's own, an upper bound of what was held at one time. Where
the system has no `/proc`, the mark cannot be reset and the process's peak so far is reported.
"""

from __future__ import annotations

import contextlib
import sys
import threading
from pathlib import Path
from types import TracebackType

_WATCH_EVERY_S = 0.02


class PeakMemory:
    """Measures between entering and leaving a `with` block; read `mib` afterwards."""

    def __init__(self) -> None:
        """Prepare; nothing is measured yet."""
        self.mib = 0.0
        self._children_kib: dict[str, int] = {}
        self._stop = threading.Event()
        self._watcher = threading.Thread(target=self._watch, daemon=True)

    def __enter__(self) -> PeakMemory:
        """Reset the mark and start to watch."""
        with contextlib.suppress(OSError):
            Path("/proc/self/clear_refs").write_text("5", encoding="ascii")
        self._watcher.start()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        value: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Stop and sum up."""
        self._stop.set()
        self._watcher.join()
        own_kib = _high_water_kib("self") or _peak_so_far_kib()
        self.mib = (own_kib + sum(self._children_kib.values())) / 1024

    def _watch(self) -> None:
        while not self._stop.wait(_WATCH_EVERY_S):
            for child in _children():
                size = _high_water_kib(child)
                self._children_kib[child] = max(size, self._children_kib.get(child, 0))


def available_bytes() -> int | None:
    """Return how much this process may still take, of the machine and of its control group.

    None where the system does not say.
    """
    found = [room for room in (_machine_room(), _group_room()) if room is not None]
    return min(found, default=None)


def _machine_room() -> int | None:
    try:
        for line in Path("/proc/meminfo").read_text(encoding="ascii").splitlines():
            if line.startswith("MemAvailable:"):
                return int(line.split()[1]) * 1024
    except (OSError, ValueError):
        pass
    return None


def _group_room() -> int | None:
    group = Path("/sys/fs/cgroup")
    try:
        most = (group / "memory.max").read_text(encoding="ascii").strip()
        held = int((group / "memory.current").read_text(encoding="ascii"))
        # Of what is held, the cached files would make room.
        stat = (group / "memory.stat").read_text(encoding="ascii").splitlines()
        cached = sum(int(line.split()[1]) for line in stat if line.startswith("inactive_file "))
        return None if most == "max" else int(most) - held + cached
    except (OSError, ValueError):
        return None


def _children() -> list[str]:
    found: list[str] = []
    try:
        for task in Path("/proc/self/task").iterdir():
            found += (task / "children").read_text(encoding="ascii").split()
    except OSError:
        pass
    return found


def _high_water_kib(pid: str) -> int:
    try:
        status = Path(f"/proc/{pid}/status").read_text(encoding="utf-8", errors="replace")
    except OSError:
        return 0
    for line in status.splitlines():
        if line.startswith("VmHWM:"):
            return int(line.split()[1])
    return 0


def _peak_so_far_kib() -> int:
    try:
        import resource
    except ImportError:
        return 0
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return peak // 1024 if sys.platform == "darwin" else peak
