"""The command among terminals, pipes and signals."""

from __future__ import annotations

import os
import pty
import re
import signal
import subprocess
import time
from pathlib import Path

import pytest
from command_line import COMMAND, SCENE, call, environment, fake_povray, scene_file

#: Escape sequences that set a colour: 30-37, 38, 40-48, 90-97.
COLOR = re.compile(rb"\x1b\[(?:\d+;)*(?:3[0-8]|4[0-8]|9[0-7])(?:;\d+)*m")


def on_terminal(*words: object, env: dict[str, str] | None = None) -> tuple[int, bytes]:
    """Run the command on a terminal of its own; return its status and what the terminal got."""
    try:
        ours, its = pty.openpty()
    except OSError as error:
        pytest.skip(f"this system gives no pseudo-terminal: {error}")
    terminal = {"TERM": "xterm-256color", **(env or {})}
    with subprocess.Popen(
        [*COMMAND, *map(str, words)],
        stdin=its, stdout=its, stderr=its, env=environment(terminal), close_fds=True,
    ) as process:  # fmt: skip
        os.close(its)
        shown = b""
        try:
            while block := os.read(ours, 1 << 16):
                shown += block
        except OSError:
            # So a terminal of Linux says that nobody writes to it any more.
            pass
        os.close(ours)
    return process.returncode, shown


def test_a_terminal_gets_a_bar_and_colours(tmp_path: Path) -> None:
    """On a terminal the cursor moves and statuses are coloured."""
    words = ("run", scene_file(tmp_path), "-o", tmp_path / "out", "--renderers", "native")
    status, shown = on_terminal(*words)
    assert status == 0
    assert COLOR.search(shown)
    assert b"2/2" in shown


def test_no_color_takes_the_colours_away(tmp_path: Path) -> None:
    """Under NO_COLOR the terminal gets the same without a colour."""
    words = ("run", scene_file(tmp_path), "-o", tmp_path / "out", "--renderers", "native")
    status, shown = on_terminal(*words, env={"NO_COLOR": "1"})
    assert status == 0
    assert b"native" in shown
    assert not COLOR.search(shown)


def test_elsewhere_than_on_a_terminal_lines_are_plain_and_short(tmp_path: Path) -> None:
    """A pipe gets no escape sequence, and tables within 80 columns however long a name is."""
    scene = scene_file(tmp_path, name="a-scene-with-a-very-long-name-that-goes-on-and-on.txt")
    words = ("run", scene, "-o", "out", "--renderers", "native,mitsuba-f64")
    done = call(*words, cwd=tmp_path)
    assert done.returncode == 0
    assert "\x1b" not in done.stdout + done.stderr
    assert max(map(len, done.stdout.splitlines())) <= 80
    assert "[4/4] " in done.stderr


def test_quiet_is_silent(tmp_path: Path) -> None:
    """Nothing at all is said where all is well."""
    scene = scene_file(tmp_path)
    for words in (("render", scene, "-o", tmp_path / "x.npy"),
                  ("run", scene, "-o", tmp_path / "out", "--renderers", "native")):  # fmt: skip
        done = call(*words, "--quiet")
        assert (done.returncode, done.stdout, done.stderr) == (0, "", "")


def test_a_reader_that_has_seen_enough_causes_no_complaint(tmp_path: Path) -> None:
    """The pipe breaks in the middle of a long output: no traceback, no message."""
    numbers = SCENE.splitlines()
    plane = numbers[7]
    many = [*numbers[:5], "20000", *[plane] * 20000, *numbers[8:]]
    scene = scene_file(tmp_path, "\n".join(many))
    with subprocess.Popen(
        [*COMMAND, "effects", str(scene), "--json"],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, env=environment(),
    ) as process:  # fmt: skip
        assert process.stdout is not None and process.stderr is not None
        assert process.stdout.read(10)
        process.stdout.close()
        assert process.stderr.read() == b""
    assert process.returncode == 141


def test_a_name_that_is_no_text_breaks_nothing(tmp_path: Path) -> None:
    """A file name of bytes that are not UTF-8, and an ASCII locale, are still answered in words."""
    name = os.fsdecode(b"caf\xe9.txt")
    scene_file(tmp_path, SCENE + "7", name)
    done = call("effects", name, cwd=tmp_path, env={"LC_ALL": "C", "PYTHONUTF8": "0"})
    assert done.returncode == 2
    assert ":12:1: expected " in done.stderr


@pytest.mark.parametrize(("sent", "status"), [(signal.SIGINT, 130), (signal.SIGTERM, 143)])
@pytest.mark.parametrize("command", ["render", "run"])
def test_an_interrupt_ends_at_once_and_leaves_nothing(
    tmp_path: Path, command: str, sent: signal.Signals, status: int
) -> None:
    """While a renderer hangs, an interrupt ends the command and the renderer, without a traceback.

    The renderer would sleep for longer than the test may take.
    """
    work = tmp_path / "work"
    work.mkdir()
    started = tmp_path / "started"
    scratch = tmp_path / "scratch"
    scratch.mkdir()
    env = fake_povray(tmp_path, f'echo $$ > "{started}.new"; mv "{started}.new" "{started}"; '
                                "exec sleep 1000")  # fmt: skip
    scene = scene_file(tmp_path)
    words = {
        "render": ["render", str(scene), "--with", "povray", "-o", "x.npz"],
        "run": ["run", str(scene), "--renderers", "native,povray", "-o", "out"],
    }[command]
    with subprocess.Popen(
        [*COMMAND, *words], cwd=work, env=environment({**env, "TMPDIR": str(scratch)}),
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True,
    ) as process:  # fmt: skip
        _wait_for(started)
        process.send_signal(sent)
        output, errors = process.communicate(timeout=60)
    assert process.returncode == status
    assert "Traceback" not in output + errors
    assert list(work.iterdir()) == []
    assert list(scratch.iterdir()) == []
    assert _is_gone(int(started.read_text(encoding="ascii")))


def _wait_for(path: Path) -> None:
    for _ in range(1200):
        if path.exists():
            return
        time.sleep(0.05)
    raise AssertionError("the renderer was never started")


def _is_gone(pid: int) -> bool:
    for _ in range(100):
        try:
            state = Path(f"/proc/{pid}/stat").read_text(encoding="utf-8").rpartition(")")[2].split()
        except OSError:
            return True
        # A zombie has ended; whoever inherits it has not yet asked for its status.
        if state[0] == "Z":
            return True
        time.sleep(0.05)
    return False


def test_progress_says_stage_rate_and_time_left(tmp_path: Path) -> None:
    """On a terminal the bar has them beside the count, within 80 columns, and no colour under
    NO_COLOR; elsewhere lines end with them.
    """
    scene_file(tmp_path)
    words = ("study", tmp_path / "tiny.txt", "--renderers", "native", "--samples", "4",
             "--size", "48x64")  # fmt: skip
    status, shown = on_terminal(*words, env={"NO_COLOR": "1"})
    assert status == 0
    plain = re.sub(rb"\x1b\[[0-9;?]*[A-Za-z]", b"", shown).decode()
    bars = [line for line in re.split(r"[\r\n]+", plain) if re.search(r"\d+/\d+ ", line)]
    assert any(re.search(r"\d+/\d+ +[\d.]+(/s|s each), .* left +timing +tiny", it) for it in bars)
    assert max(map(len, bars)) <= 80
    assert not COLOR.search(shown)
    done = call(*words)
    assert done.returncode == 0
    assert re.search(r"^\[\d+/\d+\] timing tiny .* \(in [\d.]+ s\)$", done.stderr, re.M)
