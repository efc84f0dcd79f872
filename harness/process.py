"""One worker process as its owner sees it: start, exchange a job for an answer, kill."""

from __future__ import annotations

import contextlib
import os
import select
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from io import FileIO
from pathlib import Path
from typing import Any, cast

from crosstrace.harness import wire

#: The thread counts that the libraries of a renderer read at import.
_THREAD_VARIABLES = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")

_PIPE_SIZE = 1 << 20
_LOG_TAIL = 600


class WorkerDiedError(Exception):
    """The process ended before it answered; the text says how."""


class WorkerTimeoutError(Exception):
    """The time limit passed before the answer came; the process has been killed."""


class WorkerProcess:
    """A worker in a session of its own; jobs go to it one at a time.

    `scratch` is a directory for its log and for the temporary files of what runs in it. `threads`
    bounds the thread pools of numerical libraries; 0 leaves them alone.
    """

    def __init__(self, scratch: Path, name: str, threads: int = 0) -> None:
        """Start the process; it is ready when its first answer comes."""
        self._log_path = scratch / f"{name}.log"
        self._reaping = threading.Lock()
        lifeline, owned = os.pipe()
        self._lifeline = FileIO(owned, "w")
        try:
            with self._log_path.open("wb") as log:
                self._process = subprocess.Popen(
                    [sys.executable, "-P", "-m", "crosstrace.harness.worker", str(lifeline)],
                    stdin=subprocess.PIPE,
                    stdout=subprocess.PIPE,
                    stderr=log,
                    bufsize=0,
                    pass_fds=[lifeline],
                    start_new_session=True,
                    env=_environment(scratch, threads),
                )
        finally:
            os.close(lifeline)
        self._input = cast(FileIO, self._process.stdin)
        self._output = cast(FileIO, self._process.stdout)
        for pipe in (self._input, self._output):
            os.set_blocking(pipe.fileno(), False)
            _widen(pipe.fileno())

    def exchange(
        self,
        job: bytes,
        timeout_s: float | None = None,
        on_progress: Callable[[float], None] | None = None,
    ) -> Any:
        """Send a packed job and return its answer, ("result", …) or ("error", …).

        Raises WorkerDiedError or WorkerTimeoutError, in both cases with the process gone.
        """
        deadline = None if timeout_s is None else time.monotonic() + timeout_s
        log_start = self._log_size()
        try:
            self._write(job, deadline)
            while True:
                length = wire.HEADER.unpack(self._read(wire.HEADER.size, deadline))[0]
                message = wire.unpack(self._read(length, deadline))
                if message[0] != "progress":
                    return message
                if on_progress is not None:
                    on_progress(message[1])
        except (EOFError, BrokenPipeError, ConnectionResetError):
            self.kill()
            raise WorkerDiedError(self._obituary(log_start)) from None
        except WorkerTimeoutError:
            self.kill()
            raise

    @property
    def alive(self) -> bool:
        """Whether the process can still take a job."""
        return self._process.poll() is None

    def kill(self) -> None:
        """Kill the process and all that it started, and reap it; harmless when repeated."""
        # An unreaped leader keeps the group's number reserved, so no stranger can be hit.
        with self._reaping:
            if self._process.returncode is None:
                with contextlib.suppress(ProcessLookupError, PermissionError):
                    os.killpg(self._process.pid, signal.SIGKILL)
                self._process.wait()

    def close(self) -> None:
        """Kill the process and give back its file descriptors and its log."""
        self.kill()
        for pipe in (self._input, self._output, self._lifeline):
            pipe.close()
        self._log_path.unlink(missing_ok=True)

    def _write(self, data: bytes, deadline: float | None) -> None:
        view = memoryview(data)
        while view:
            self._wait(self._input.fileno(), select.POLLOUT, deadline)
            view = view[self._input.write(view) or 0 :]

    def _read(self, length: int, deadline: float | None) -> bytearray:
        body = bytearray(length)
        view = memoryview(body)
        while view:
            count = self._output.readinto(view)
            if count == 0:
                raise EOFError
            if count is None:
                self._wait(self._output.fileno(), select.POLLIN, deadline)
                continue
            view = view[count:]
        return body

    @staticmethod
    def _wait(fd: int, event: int, deadline: float | None) -> None:
        poll = select.poll()
        poll.register(fd, event)
        left_ms = None if deadline is None else max(0.0, deadline - time.monotonic()) * 1000
        if not poll.poll(left_ms):
            raise WorkerTimeoutError

    def _obituary(self, log_start: int) -> str:
        code = self._process.returncode
        if code < 0:
            how = f"crashed with signal {signal.Signals(-code).name}"
        else:
            how = f"ended with exit status {code} before it answered"
        with contextlib.suppress(OSError), self._log_path.open("rb") as log:
            log.seek(max(log_start, self._log_size() - _LOG_TAIL))
            last_words = log.read().decode("utf-8", "replace").strip()
            if last_words:
                return f"{how}: {last_words}"
        return how

    def _log_size(self) -> int:
        try:
            return self._log_path.stat().st_size
        except OSError:
            return 0


def _environment(scratch: Path, threads: int) -> dict[str, str]:
    environment = dict(os.environ)
    # The worker finds what its owner finds, also where the owner changed sys.path.
    environment["PYTHONPATH"] = os.pathsep.join(str(Path(p).absolute()) for p in sys.path)
    environment["TMPDIR"] = str(scratch)
    if threads:
        environment.update(dict.fromkeys(_THREAD_VARIABLES, str(threads)))
    return environment


def _widen(fd: int) -> None:
    """Let a pipe hold a megabyte where the system can: images then take a tenth of the turns."""
    with contextlib.suppress(ImportError, AttributeError, OSError):
        import fcntl

        fcntl.fcntl(fd, fcntl.F_SETPIPE_SZ, _PIPE_SIZE)
