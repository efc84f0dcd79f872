"""The process in which every renderer runs: `python -m crosstrace.harness.worker`.

It reads jobs from its standard input and answers on its standard output until the input ends. Both
are moved out of the way first: libraries that print would corrupt the answers, and a child process
would eat the jobs. The process leads a session of its own, so its owner can kill it together with
its children (POV-Ray). It dies with its owner: one argument names a pipe on which nothing is ever
written and whose other end only the owner holds.
"""

from __future__ import annotations

import os
import signal
import sys
import threading
import time
import traceback
from typing import BinaryIO

from crosstrace.harness import wire

#: Progress is told no more often than this.
_PROGRESS_EVERY_S = 0.1


def main() -> None:
    """Serve jobs until the owner closes the pipe."""
    _die_with_owner(int(sys.argv[1]))
    # An interrupt of the terminal is the owner's business: it decides who is killed.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    source = os.fdopen(os.dup(0), "rb", buffering=1 << 16)
    sink = os.fdopen(os.dup(1), "wb", buffering=0)
    with open(os.devnull, "rb") as nothing:  # noqa: PTH123 - a device, not a path
        os.dup2(nothing.fileno(), 0)
    os.dup2(2, 1)
    while (body := wire.read_frame(source)) is not None:
        _send(sink, _answer(body, sink))
        del body


def _answer(body: bytes, sink: BinaryIO) -> bytes:
    try:
        function, args, kwargs, wants_progress = wire.unpack(body)
        if wants_progress:
            kwargs["progress"] = _Teller(sink)
        return wire.pack(("result", function(*args, **kwargs)))
    except BaseException as error:
        return _pack_error(error)


def _pack_error(error: BaseException) -> bytes:
    text = "".join(traceback.format_exception(error))
    try:
        frame = wire.pack(("error", error, text))
        wire.unpack(frame[wire.HEADER.size :])
    except Exception:
        # Some exceptions pickle but cannot be made again from their parts.
        return wire.pack(("error", None, text))
    return frame


class _Teller:
    """Tells the owner the fraction done, now and then."""

    def __init__(self, sink: BinaryIO) -> None:
        self._sink, self._last = sink, 0.0

    def __call__(self, fraction: float) -> None:
        now = time.monotonic()
        if now - self._last >= _PROGRESS_EVERY_S:
            self._last = now
            _send(self._sink, wire.pack(("progress", float(fraction))))


def _send(sink: BinaryIO, frame: bytes) -> None:
    view = memoryview(frame)
    while view:
        view = view[sink.write(view) :]


def _die_with_owner(lifeline: int) -> None:
    """Have the whole process group killed when the last writer of the lifeline is gone.

    On Linux the kernel does it, so that a library which hangs inside C code with Python's lock held
    dies too; elsewhere a thread watches.
    """
    try:
        import fcntl

        fcntl.fcntl(lifeline, fcntl.F_SETOWN, -os.getpgrp())
        fcntl.fcntl(lifeline, fcntl.F_SETSIG, signal.SIGKILL)
        fcntl.fcntl(lifeline, fcntl.F_SETFL, os.O_ASYNC)
    except (ImportError, AttributeError, OSError):
        pass
    # The thread also covers an owner that was gone before the kernel was asked.
    threading.Thread(target=_watch, args=(lifeline,), daemon=True).start()


def _watch(lifeline: int) -> None:
    os.read(lifeline, 1)
    os.killpg(os.getpgrp(), signal.SIGKILL)


if __name__ == "__main__":
    main()
