"""A pool of worker processes behind the interface of `concurrent.futures.Executor`.

Callers use `submit` and `as_completed` alone, so that an executor of a cluster can stand in. A
`Task` says what only this pool heeds: which worker a job prefers and how long it may take.
"""

from __future__ import annotations

import bisect
import contextlib
import os
import shutil
import tempfile
import threading
import weakref
from collections import Counter
from collections.abc import Callable
from concurrent.futures import Executor, Future
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from crosstrace.harness import wire
from crosstrace.harness.process import WorkerDiedError, WorkerProcess, WorkerTimeoutError
from crosstrace.translators.errors import RendererError, RendererTimeoutError

#: Idle workers that are kept warm beyond the number of slots.
_SPARE_WORKERS = 6


@dataclass(frozen=True)
class Task:
    """A function to submit, with hints for a `WorkerPool`; any other executor just calls it.

    A worker serves one `affinity` only, so what a lane loaded once stays warm for its next job.
    Jobs of lower `rank` go first, those of one rank in the order in which they came. `timeout_s`
    bounds the job, `label` names it in errors, and `on_progress`, called in a thread of the pool,
    makes the function receive a `progress` argument that calls it back.
    """

    function: Callable[..., Any]
    affinity: str = ""
    rank: int = 0
    timeout_s: float | None = None
    label: str = "the job"
    on_progress: Callable[[float], None] | None = None

    def __call__(self, *args: Any, **kwargs: Any) -> Any:
        """Call the function."""
        return self.function(*args, **kwargs)

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle without the callback, which belongs to this process."""
        return Task, (self.function, self.affinity, self.rank, self.timeout_s, self.label)


@dataclass
class _Item:
    future: Future[Any]
    task: Task
    job: bytes


class WorkerPool(Executor):
    """Runs at most `slots` jobs at once, each in a worker process; workers are started on demand.

    `threads` bounds the thread pools of numerical libraries in each worker (0: no bound). A job
    that passes its time limit or whose process dies fails with RendererError, and only that process
    is replaced. Leaving the pool's `with` block by an exception kills everything at once.
    """

    def __init__(self, slots: int, *, threads: int = 0) -> None:
        """Make the pool; processes start with the first jobs."""
        self.slots, self._threads = max(1, slots), threads
        self.scratch = Path(tempfile.mkdtemp(prefix="crosstrace-"))
        self._state = threading.Condition()
        self._queue: list[_Item] = []
        self._idle: list[tuple[str, WorkerProcess]] = []
        self._live: dict[WorkerProcess, str] = {}
        self._runners: list[threading.Thread] = []
        self._resting = 0
        self._started = 0
        self._closed = False
        self._finalizer = weakref.finalize(self, _clear, self._live, self.scratch, os.getpid())

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        """Queue a call of a picklable function; a Task's hints are heeded."""
        task = fn if isinstance(fn, Task) else Task(fn)
        job = wire.pack((task.function, args, kwargs, task.on_progress is not None))
        item = _Item(Future(), task, job)
        with self._state:
            if self._closed:
                raise RuntimeError("the pool is shut down")
            bisect.insort(self._queue, item, key=lambda queued: queued.task.rank)
            if len(self._queue) > self._resting and len(self._runners) < self.slots:
                runner = threading.Thread(target=self._run, daemon=True)
                self._runners.append(runner)
                runner.start()
            self._state.notify()
        return item.future

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """End the workers, after the queued jobs unless these are cancelled."""
        with self._state:
            self._closed = True
            if cancel_futures:
                self._cancel_queue()
            self._state.notify_all()
        if wait:
            for runner in self._runners:
                runner.join()
            for worker in list(self._live):
                self._discard(worker)
            self._finalizer()

    def kill(self) -> None:
        """Kill every worker now, with its children; running jobs fail, queued ones don't start."""
        with self._state:
            self._closed = True
            self._cancel_queue()
            for worker in list(self._live):
                worker.kill()
            self._state.notify_all()
        self._finalizer()

    def __exit__(self, kind: Any, value: Any, trace: Any) -> None:
        """Shut down; by an exception, at once."""
        if kind is None:
            self.shutdown()
        else:
            self.kill()

    def _cancel_queue(self) -> None:
        while self._queue:
            self._queue.pop().future.cancel()

    def _run(self) -> None:
        while (picked := self._pick()) is not None:
            item, worker = picked
            if not item.future.set_running_or_notify_cancel():
                if worker is not None:
                    self._release(item.task.affinity, worker)
                continue
            try:
                worker = worker or self._start(item.task.affinity)
                outcome = _exchange(worker, item)
            except BaseException as error:
                outcome = error
            if worker is not None:
                self._release(item.task.affinity, worker)
            if isinstance(outcome, BaseException):
                item.future.set_exception(outcome)
            else:
                item.future.set_result(outcome[0])

    def _pick(self) -> tuple[_Item, WorkerProcess | None] | None:
        """Wait for a job and choose its worker; None for the worker: a new one is to be started.

        In the order of the queue the first job is taken that finds a warm worker or whose kind has
        none at all. Only where all kinds are busy does one get a second worker.
        """
        with self._state:
            while not self._queue:
                if self._closed:
                    return None
                self._resting += 1
                self._state.wait()
                self._resting -= 1
            warm = {affinity: i for i, (affinity, _) in enumerate(self._idle)}
            workers = Counter(self._live.values())
            for position, item in enumerate(self._queue):
                if item.task.affinity in warm:
                    del self._queue[position]
                    return item, self._idle.pop(warm[item.task.affinity])[1]
                if not workers[item.task.affinity]:
                    return self._queue.pop(position), None
            fewest = min(range(len(self._queue)), key=lambda i: workers[self._kind(i)])
            return self._queue.pop(fewest), None

    def _kind(self, position: int) -> str:
        return self._queue[position].task.affinity

    def _start(self, affinity: str) -> WorkerProcess:
        with self._state:
            if self._closed and not self._finalizer.alive:
                raise RendererError("the run was cancelled")
            self._started += 1
            while len(self._live) >= self.slots + _SPARE_WORKERS and self._idle:
                self._discard(self._idle.pop(0)[1])
            worker = WorkerProcess(self.scratch, f"worker-{self._started}", self._threads)
            self._live[worker] = affinity
            return worker

    def _release(self, affinity: str, worker: WorkerProcess) -> None:
        with self._state:
            if worker.alive and self._finalizer.alive:
                self._idle.append((affinity, worker))
            else:
                self._discard(worker)

    def _discard(self, worker: WorkerProcess) -> None:
        self._live.pop(worker, None)
        worker.close()


def _exchange(worker: WorkerProcess, item: _Item) -> tuple[Any] | BaseException:
    task = item.task
    try:
        answer = worker.exchange(item.job, task.timeout_s, task.on_progress)
    except WorkerTimeoutError:
        return RendererTimeoutError(f"{task.label} timed out after {task.timeout_s:g} s")
    except WorkerDiedError as death:
        return RendererError(f"{task.label} {death}")
    if answer[0] == "result":
        return (answer[1],)
    _, error, text = answer
    if error is None:
        error = RendererError(f"{task.label} failed: {text.strip().splitlines()[-1]}")
    error.add_note(f"In the worker process:\n{text}")
    return error if isinstance(error, BaseException) else RendererError(text)


def _clear(live: dict[WorkerProcess, str], scratch: Path, owner: int) -> None:
    """Kill what is left and remove the scratch directory, unless this is a fork of the owner."""
    if os.getpid() != owner:
        return
    for worker in list(live):
        # Killed, not closed: a thread of the pool may just be reading its pipes.
        with contextlib.suppress(OSError):
            worker.kill()
    shutil.rmtree(scratch, ignore_errors=True)


def available_cores() -> int:
    """Return the number of processor cores that this process may use."""
    try:
        return len(os.sched_getaffinity(0))
    except AttributeError:
        return os.cpu_count() or 1
