"""Runs in which renderers, users or the file system misbehave: recorded, and no debris is left."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from pathlib import Path

import pytest
from small_runs import EMPTY, entry_of, run_options

from crosstrace.harness.outcome import exit_status
from crosstrace.harness.schedule import Event
from crosstrace.harness.session import run
from crosstrace.translators import leftovers
from crosstrace.translators.errors import UsageError
from crosstrace.translators.scene import Scene

PLAIN = "fake_lanes:Plain"


@pytest.mark.parametrize(
    ("lane", "status", "says"),
    [
        ("fake_lanes:Absent", "missing", "no such program <script> (install it with: apt-get"),
        ("fake_lanes:Crashing", "failed", "crashed with signal SIGSEGV"),
        ("fake_lanes:Refusing", "unsupported", "no scene at all"),
        ("fake_lanes:Wrongly", "failed", "expected an image (12, 16, 3), found (1, 1, 3)"),
        ("no_such_module:Thing", "failed", "No module named 'no_such_module'"),
    ],
)
def test_a_renderer_that_fails_is_recorded_and_the_rest_goes_on(
    scene: Scene, tmp_path: Path, lane: str, status: str, says: str
) -> None:
    """Never a pass: the scene is incomplete, the exit status 3, the other image is there."""
    report = run([scene, scene], tmp_path / "out", run_options(PLAIN, lane))
    for i in (0, 1):
        failed = entry_of(report, lane, i)
        assert failed["status"] == status
        assert says in failed["message"]
        assert failed["images"] == {}
        assert failed["seconds"]["render"] is None
        assert entry_of(report, PLAIN, i)["status"] == "ok"
        assert report["scenes"][i]["verdict"] == "incomplete"
        (pair,) = report["scenes"][i]["pairs"]
        assert pair["pixels"] is None
        assert lane in pair["message"]
    assert exit_status(report) == 3


def test_a_renderer_that_hangs_is_given_up_after_the_time_limit(
    scene: Scene, tmp_path: Path
) -> None:
    """Its process is killed, the message says so, and the other renderer's image is kept."""
    options = run_options(PLAIN, "fake_lanes:Hanging", timeout_s=1.0)
    report = run([scene], tmp_path / "out", options)
    hung = entry_of(report, "fake_lanes:Hanging")
    assert hung["status"] == "failed"
    assert "timed out after" in hung["message"]
    assert entry_of(report, PLAIN)["status"] == "ok"
    assert exit_status(report) == 3


def test_a_renderer_that_hangs_twice_is_not_asked_again(scene: Scene, tmp_path: Path) -> None:
    """A lane that hangs on every scene costs two time limits, not one a scene."""
    options = run_options(PLAIN, "fake_lanes:Hanging", timeout_s=0.5, jobs=1)
    report = run([scene] * 6, tmp_path / "out", options)
    messages = [entry_of(report, "fake_lanes:Hanging", i)["message"] for i in range(6)]
    hung = [message for message in messages if "timed out after" in message]
    assert len(hung) in (2, 3)  # a third may have been under way
    assert sum("not asked" in message for message in messages) == 6 - len(hung)
    assert all(entry_of(report, PLAIN, i)["status"] == "ok" for i in range(6))
    assert exit_status(report) == 3


def test_a_pixel_that_is_not_a_number_is_counted_and_never_reaches_the_json(
    scene: Scene, tmp_path: Path
) -> None:
    """It is beyond every threshold, and the numbers that it spoils are null."""
    report = run(
        [scene], tmp_path / "out", run_options("fake_lanes:Gradient", "fake_lanes:Undefined")
    )
    assert entry_of(report, "fake_lanes:Undefined")["nonfinite"] == 1
    (pair,) = report["scenes"][0]["pairs"]
    assert (pair["max"], pair["rmse"], pair["ssim"]) == (None, None, None)
    assert pair["over_1_255"] == pair["nonfinite"] == 1
    text = (tmp_path / "out/report.json").read_text(encoding="utf-8")
    assert "NaN" not in text
    assert "Infinity" not in text


def test_a_directory_that_cannot_be_is_refused_before_any_rendering(
    scene: Scene, tmp_path: Path
) -> None:
    """A file stands in its place."""
    (tmp_path / "out").write_text("a file", encoding="utf-8")
    with pytest.raises(UsageError, match="expected a directory, found a file"):
        run([scene], tmp_path / "out", run_options(PLAIN))


def test_an_observer_that_raises_ends_the_run_and_leaves_nothing(
    scene: Scene, tmp_path: Path
) -> None:
    """So does an interrupt: no half-written report, no scratch directory."""

    def interrupt(event: Event) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        run([scene], tmp_path / "out", run_options(PLAIN), interrupt)
    assert list(tmp_path.iterdir()) == []


def test_what_a_killed_run_left_goes_with_the_next_one(scene: Scene, tmp_path: Path) -> None:
    """Its half-built report stands where the directory is; nothing was written to it for long."""
    left = tmp_path / "out/.crosstrace-report-killed_1"
    left.mkdir(parents=True)
    then = time.time() - 2 * leftovers.QUIET_S
    os.utime(left, (then, then))
    run([scene], tmp_path / "out", run_options(PLAIN))
    assert {path.name for path in (tmp_path / "out").iterdir()} == {
        "images", "report.html", "report.json", "report.md",
    }  # fmt: skip


def test_an_interrupted_process_leaves_at_once_although_a_renderer_hangs(tmp_path: Path) -> None:
    """The signal of the terminal reaches the owner, which kills its workers."""
    script = (
        "import sys, pathlib; sys.path.insert(0, sys.argv[1])\n"
        "from crosstrace.harness.session import RunOptions, run\n"
        "from crosstrace.translators.course import parse\n"
        "def tell(event): print(event.kind, flush=True)\n"
        "try: run([parse(sys.argv[3])], pathlib.Path(sys.argv[2]),\n"
        "    RunOptions(('fake_lanes:Hanging',), timeout_s=None), tell)\n"
        "except KeyboardInterrupt: sys.exit(130)\n"
    )
    here, out = str(Path(__file__).parent), tmp_path / "out"
    process = subprocess.Popen(
        [sys.executable, "-c", script, here, str(out), EMPTY], stdout=subprocess.PIPE, text=True
    )
    assert process.stdout is not None
    assert process.stdout.readline() == "start\n"
    time.sleep(0.2)
    process.send_signal(2)
    process.communicate(timeout=60)
    assert process.returncode == 130
    assert list(tmp_path.iterdir()) == []
