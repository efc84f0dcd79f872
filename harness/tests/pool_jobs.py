"""Jobs that misbehave, for the tests of the worker pool; they run in worker processes."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any, NoReturn


class AwkwardError(Exception):
    """Pickles, but cannot be made again from its parts."""

    def __init__(self, first: str, second: str) -> None:
        """Take two arguments and keep one."""
        super().__init__(first)


def pid() -> int:
    """Tell which process this is."""
    return os.getpid()


def add(a: int, b: int) -> int:
    """Add."""
    return a + b


def blob(size: int) -> bytes:
    """Return many bytes."""
    return b"x" * size


def length(data: bytes) -> int:
    """Count the bytes that came."""
    return len(data)


def print_noise() -> str:
    """Write to standard output at every level."""
    print("noise", flush=True)
    os.write(1, b"\x00\x01noise of a C library")
    subprocess.run([sys.executable, "-c", "print('noise of a child')"], check=True)
    return sys.stdin.read()


def fail(message: str) -> NoReturn:
    """Raise."""
    raise ValueError(message)


def fail_awkwardly() -> NoReturn:
    """Raise what cannot come back as it is."""
    raise AwkwardError("the first", "the second")


def unpicklable() -> Callable[[], None]:
    """Return what cannot be sent."""
    return lambda: None


def leave() -> NoReturn:
    """End the process politely."""
    sys.exit(5)


def end_hard(status: int) -> NoReturn:
    """End the process at once."""
    os._exit(status)


def abort() -> NoReturn:
    """Die as LLVM does, with last words."""
    print("LLVM ERROR: cannot select", file=sys.stderr, flush=True)
    os.abort()


def kill_self(number: int) -> None:
    """Die of a signal."""
    os.kill(os.getpid(), number)
    time.sleep(60)


def hang(marker: str = "") -> None:
    """Never end, with a child that never ends, deaf to gentle signals; say so in a file."""
    signal.signal(signal.SIGTERM, signal.SIG_IGN)
    child = subprocess.Popen(["sleep", "600"])
    if marker:
        temporary = Path(marker + ".new")
        temporary.write_text(f"{os.getpid()} {child.pid}", encoding="ascii")
        temporary.rename(marker)
    while True:
        time.sleep(60)


def count_to(n: int, progress: Callable[[float], None]) -> int:
    """Tell the fraction done."""
    for i in range(n):
        progress(i / n)
        time.sleep(0.11)
    return n


def environment(*names: str) -> dict[str, Any]:
    """Return variables of the worker."""
    return {name: os.environ.get(name) for name in names}


def is_leader() -> bool:
    """Whether this process leads a session."""
    return os.getsid(0) == os.getpid()
