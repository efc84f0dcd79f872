"""Worker processes: what goes through the pipe, and what happens to those that misbehave."""

from __future__ import annotations

import os
import pickle
import signal
import subprocess
import sys
import time
from concurrent.futures import Executor, Future, as_completed
from pathlib import Path

import pool_jobs
import pytest

from crosstrace.harness.jobs import Task, WorkerPool
from crosstrace.translators.errors import RendererError, SceneError


def test_the_pool_is_an_executor_whose_futures_the_standard_library_understands(
    pool: WorkerPool,
) -> None:
    """Callers use submit and as_completed alone, so that another executor can stand in."""
    assert isinstance(pool, Executor)
    futures = [pool.submit(pool_jobs.add, i, b=1) for i in range(5)]
    assert sorted(future.result() for future in as_completed(futures)) == [1, 2, 3, 4, 5]
    assert list(pool.map(pool_jobs.add, [1, 2], [3, 4])) == [4, 6]


def test_a_worker_is_reused_and_is_another_process(pool: WorkerPool) -> None:
    """What a job loaded stays warm for the next."""
    first, second = pool.submit(pool_jobs.pid).result(), pool.submit(pool_jobs.pid).result()
    assert first == second != os.getpid()
    assert pool.submit(pool_jobs.is_leader).result()


def test_a_worker_serves_one_affinity_only(pool: WorkerPool) -> None:
    """Two lanes never share a process, and each finds its own again."""
    a, b = Task(pool_jobs.pid, "a"), Task(pool_jobs.pid, "b")
    pids = [pool.submit(task).result() for task in (a, b, a, b)]
    assert pids[0] == pids[2] != pids[1] == pids[3]


def test_jobs_of_lower_rank_go_first() -> None:
    """The scenes come one after the other, not the lanes."""
    order: list[int] = []
    with WorkerPool(1) as pool:
        blocker = pool.submit(time.sleep, 0.3)
        futures = {pool.submit(Task(pool_jobs.pid, rank=rank)): rank for rank in (3, 1, 2, 1)}
        for future in futures:
            future.add_done_callback(lambda done: order.append(futures[done]))
        blocker.result()
    assert order == [1, 1, 2, 3]


def test_huge_arguments_and_results_pass(pool: WorkerPool) -> None:
    """More than a pipe holds, in both directions."""
    size = 50_000_000
    assert len(pool.submit(pool_jobs.blob, size).result()) == size
    assert pool.submit(pool_jobs.length, b"y" * size).result() == size


def test_prints_of_libraries_and_children_do_not_reach_the_answers(pool: WorkerPool) -> None:
    """Standard output is moved away, and standard input holds no jobs for a child to eat."""
    assert pool.submit(pool_jobs.print_noise).result() == ""
    assert pool.submit(pool_jobs.add, 1, 1).result() == 2


def test_an_exception_comes_back_as_itself_with_the_place_where_it_arose(pool: WorkerPool) -> None:
    """The traceback of the worker is a note of the exception."""
    with pytest.raises(ValueError, match="not so") as caught:
        pool.submit(pool_jobs.fail, "not so").result()
    assert "pool_jobs.py" in "".join(caught.value.__notes__)


def test_an_exception_that_cannot_travel_becomes_a_renderer_error(pool: WorkerPool) -> None:
    """Its text is kept, and the worker lives on."""
    with pytest.raises(RendererError, match="AwkwardError: the first"):
        pool.submit(pool_jobs.fail_awkwardly).result()
    with pytest.raises((AttributeError, pickle.PicklingError, TypeError, RendererError)):
        pool.submit(pool_jobs.unpicklable).result()
    assert pool.submit(pool_jobs.add, 1, 1).result() == 2


def test_an_error_of_a_scene_keeps_its_parts_on_the_way() -> None:
    """Line and column survive the pipe."""
    error = pickle.loads(pickle.dumps(SceneError("a.txt", 3, 7, "a number", "'x'")))
    assert (error.path, error.line, error.column) == ("a.txt", 3, 7)


@pytest.mark.parametrize(
    ("number", "name"), [(signal.SIGSEGV, "SIGSEGV"), (signal.SIGKILL, "SIGKILL")]
)
def test_a_job_whose_process_dies_of_a_signal_fails_by_its_name(
    pool: WorkerPool, number: int, name: str
) -> None:
    """The next job gets a new process."""
    before = pool.submit(pool_jobs.pid).result()
    task = Task(pool_jobs.kill_self, label="the lane")
    with pytest.raises(RendererError, match=f"the lane crashed with signal {name}"):
        pool.submit(task, int(number)).result()
    assert pool.submit(pool_jobs.pid).result() != before


def test_the_last_words_of_an_aborted_process_are_told(pool: WorkerPool) -> None:
    """LLVM says why it aborts, on standard error."""
    with pytest.raises(RendererError, match="crashed with signal SIGABRT: LLVM ERROR: cannot sel"):
        pool.submit(pool_jobs.abort).result()


def test_a_process_that_ends_by_itself_fails_its_job(pool: WorkerPool) -> None:
    """Even with status 0 it gave no answer; sys.exit alone is just an exception."""
    with pytest.raises(RendererError, match="ended with exit status 0"):
        pool.submit(pool_jobs.end_hard, 0).result()
    with pytest.raises(SystemExit):
        pool.submit(pool_jobs.leave).result()


def test_a_job_beyond_its_time_is_killed_with_its_children(
    pool: WorkerPool, tmp_path: Path
) -> None:
    """The whole process group goes, and the pool goes on."""
    marker = tmp_path / "started"
    task = Task(pool_jobs.hang, timeout_s=1.5, label="the lane")
    with pytest.raises(RendererError, match=r"the lane timed out after 1\.5 s"):
        pool.submit(task, str(marker)).result()
    for pid in marker.read_text(encoding="ascii").split():
        assert _ends(int(pid))
    assert pool.submit(pool_jobs.add, 1, 1).result() == 2


def test_an_exception_in_the_with_block_kills_everything(tmp_path: Path) -> None:
    """An interrupt does not wait for a renderer, and leaves no process and no file."""
    marker = tmp_path / "started"
    futures: list[Future[None]] = []
    pool = WorkerPool(1)

    def interrupted() -> None:
        with pool:
            futures.append(pool.submit(pool_jobs.hang, str(marker)))
            futures.append(pool.submit(pool_jobs.hang))
            _wait_for(marker)
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        interrupted()
    for pid in marker.read_text(encoding="ascii").split():
        assert _ends(int(pid))
    with pytest.raises(RendererError):
        futures[0].result(timeout=30)
    assert futures[1].cancelled()
    assert not pool.scratch.exists()


def test_workers_and_their_children_die_with_their_owner(tmp_path: Path) -> None:
    """Also where the owner is killed without a chance to clean up."""
    marker = tmp_path / "started"
    script = (
        "import sys; sys.path.insert(0, sys.argv[1])\n"
        "import pool_jobs\n"
        "from crosstrace.harness.jobs import WorkerPool\n"
        "WorkerPool(1).submit(pool_jobs.hang, sys.argv[2]).result()\n"
    )
    folder = str(Path(__file__).parent)
    environment = {**os.environ, "TMPDIR": str(tmp_path)}
    owner = subprocess.Popen([sys.executable, "-c", script, folder, str(marker)], env=environment)
    try:
        _wait_for(marker)
    finally:
        owner.kill()
        owner.wait()
    for pid in marker.read_text(encoding="ascii").split():
        assert _ends(int(pid))


def test_a_script_without_a_main_guard_can_use_the_pool(tmp_path: Path) -> None:
    """Workers are a module of ours; the user's script is not imported again."""
    script = tmp_path / "plain.py"
    script.write_text(
        "from crosstrace.harness.jobs import WorkerPool\n"
        "import operator\n"
        "print('once', WorkerPool(1).submit(operator.add, 1, 2).result())\n",
        encoding="utf-8",
    )
    done = subprocess.run(
        [sys.executable, script], capture_output=True, text=True, check=True, timeout=60
    )
    assert done.stdout == "once 3\n"


def test_progress_is_told_in_fractions_that_grow(pool: WorkerPool) -> None:
    """A job that wants to tell gets an argument for it."""
    told: list[float] = []
    task = Task(pool_jobs.count_to, on_progress=told.append)
    assert pool.submit(task, 4).result() == 4
    assert told
    assert told == sorted(told)
    assert all(0 <= fraction < 1 for fraction in told)


def test_a_task_is_a_plain_call_to_any_other_executor() -> None:
    """It pickles without its callback, which belongs to the caller's process."""
    task = Task(pool_jobs.add, "lane", 3, 1.5, "label", on_progress=lambda _: None)
    there = pickle.loads(pickle.dumps(task))
    assert there(1, 2) == 3
    assert (there.affinity, there.rank, there.timeout_s, there.label) == ("lane", 3, 1.5, "label")
    assert there.on_progress is None


def test_workers_side_by_side_get_one_thread_each_and_a_scratch_directory() -> None:
    """Temporary files of a killed renderer go with the pool."""
    with WorkerPool(2, threads=1) as pool:
        seen = pool.submit(pool_jobs.environment, "OMP_NUM_THREADS", "TMPDIR").result()
        assert seen == {"OMP_NUM_THREADS": "1", "TMPDIR": str(pool.scratch)}
    assert not pool.scratch.exists()


def test_a_pool_that_is_shut_down_takes_no_more_jobs() -> None:
    """As the standard executors do, after the queued ones are done."""
    pool = WorkerPool(1)
    future = pool.submit(pool_jobs.add, 1, 2)
    pool.shutdown()
    assert future.result() == 3
    with pytest.raises(RuntimeError, match="shut down"):
        pool.submit(pool_jobs.add, 1, 2)


def _wait_for(marker: Path) -> None:
    deadline = time.monotonic() + 60
    while not marker.exists():
        assert time.monotonic() < deadline, "the job did not start"
        time.sleep(0.01)


def _ends(pid: int) -> bool:
    """Wait for a process to be gone, or a zombie that nobody has reaped yet."""
    deadline = time.monotonic() + 30
    while time.monotonic() < deadline:
        try:
            state = Path(f"/proc/{pid}/stat").read_text(encoding="ascii").rpartition(")")[2]
        except OSError:
            return True
        if state.split()[0] == "Z":
            return True
        time.sleep(0.01)
    return False
