"""Runs the `povray` program as a child that cannot outlive or surprise its caller.

The program is the one that the environment variable CROSSTRACE_POVRAY names, otherwise `povray` on
the PATH. It gets a private working directory and HOME, an empty POVINI (its configuration files
would change the picture), no input, a process group of its own so that nothing of it survives a
timeout or Ctrl-C, and a kernel request to die with its parent where `setpriv` exists.
"""

from __future__ import annotations

import contextlib
import os
import re
import shutil
import signal
import subprocess
import time
from collections.abc import Sequence
from pathlib import Path

from crosstrace.translators.errors import RendererError, RendererMissingError, RendererTimeoutError
from crosstrace.translators.renderer import Progress

ENVIRONMENT_VARIABLE = "CROSSTRACE_POVRAY"
REMEDY = "apt-get install povray"

#: Seconds between two looks at the child: short beside its own polls of 50 and 100 ms.
_TICK_S = 0.02
_PROBE_TIMEOUT_S = 30.0
_PROGRESS = re.compile(rb"Rendered (\d+) of (\d+) pixels")
_TRACE_TIME = re.compile(
    r"Trace Time:\s+(\d+) hours\s+(\d+) minutes\s+\d+ seconds \((\d+\.\d+) seconds"
)
_RAYS = {
    "rays": re.compile(r"^Rays:\s+(\d+)", re.M),
    "reflected": re.compile(r"^Reflected Rays:\s+(\d+)", re.M),
    "refracted": re.compile(r"^Refracted Rays:\s+(\d+)", re.M),
    "shadow": re.compile(r"^Shadow Ray Tests:\s+(\d+)", re.M),
}
_LEVEL = re.compile(r"Max Level: (\d+)/(\d+)")
_FAULT = re.compile(r"error|problem|cannot|could not|failed|not found|invalid", re.IGNORECASE)
_NOISE = re.compile(r"^(Rendered \d|povray: cannot open the user configuration|POV-Ray finished)")


def find_program() -> Path:
    """Return the path of the program; raises RendererMissingError where there is none."""
    name = os.environ.get(ENVIRONMENT_VARIABLE) or "povray"
    found = shutil.which(name)
    if found is None:
        raise RendererMissingError(f"the program {name!r} is not found or not executable", REMEDY)
    return Path(found).absolute()


def find_version(program: Path, directory: Path) -> str:
    """Return the version that a program states, as in ``3.7.0.10``.

    Raises RendererMissingError where it does not behave like POV-Ray.
    """
    try:
        text = run(program, ["--version"], directory, _PROBE_TIMEOUT_S)
    except RendererMissingError:
        raise
    except RendererError as error:
        raise RendererMissingError(f"{program.name} does not work: {error}", REMEDY) from error
    match = re.search(r"POV-Ray (\d+(?:\.\d+)+)", text)
    if match is None:
        raise RendererMissingError(f"{program.name} states no POV-Ray version", REMEDY)
    return match[1]


def run(
    program: Path,
    arguments: Sequence[str],
    directory: Path,
    timeout_s: float | None = None,
    progress: Progress | None = None,
    since: float | None = None,
) -> str:
    """Run the program in a directory until it ends by itself and return what it said.

    Raises RendererMissingError where it cannot be started and RendererError where it fails, dies or
    takes longer than `timeout_s` seconds, counted from `since` on the monotonic clock (None: now);
    the child is gone whenever this function is left.
    """
    deadline = None
    if timeout_s is not None:
        deadline = (time.monotonic() if since is None else since) + timeout_s
    configuration = directory / "empty.ini"
    configuration.touch()
    environment = {
        **{name: os.environ[name] for name in ("PATH", "TMPDIR") if name in os.environ},
        "HOME": str(directory), "POVINI": str(configuration), "LC_ALL": "C",
    }  # fmt: skip
    said = directory / "messages.txt"
    with said.open("wb") as sink:
        try:
            child = subprocess.Popen(
                [*_dies_with_parent(), str(program), *arguments],
                cwd=directory, env=environment, start_new_session=True,
                stdin=subprocess.DEVNULL, stdout=sink, stderr=sink,
            )  # fmt: skip
        except OSError as error:
            reason = f"{program} cannot be started: {error.strerror}"
            raise RendererMissingError(reason, REMEDY) from error
        try:
            status = _wait(child, deadline, said, progress)
        finally:
            _end(child)
    text = _readable(said.read_bytes(), directory)
    if status is None:
        raise RendererTimeoutError(f"povray timed out after {timeout_s:g} s")
    if status < 0:
        raise RendererError(f"povray crashed with signal {-status} ({signal.strsignal(-status)})")
    if status > 0:
        raise RendererError(f"povray failed with exit status {status}: {_fault(text)}")
    return text


def warnings(text: str) -> list[str]:
    """Return the warnings among what the program said, one a line."""
    paragraphs = re.split(r"\n(?=\S)", text)
    return [" ".join(p.split()) for p in paragraphs if re.search(r"\bWarning\b", p)]


def exhausted(text: str) -> bool:
    """Say whether a ray reached the last level, out of the statistics (switch ``+GS``)."""
    level = _LEVEL.search(text)
    return level is None or int(level[1]) >= int(level[2])


def trace_seconds(text: str) -> float | None:
    """Return how long the rays took, out of the statistics; None where they do not say."""
    said = _TRACE_TIME.search(text)
    return float(said[3]) if said else None


def rays(text: str) -> dict[str, int]:
    """Return how many rays of a kind were traced, out of the statistics; a kind not told is 0.

    POV-Ray counts its other rays together; what is no reflected or refracted one is primary.
    """
    found = {name: _RAYS[name].search(text) for name in _RAYS}
    counts = {name: int(match[1]) if match else 0 for name, match in found.items()}
    primary = counts.pop("rays") - counts["reflected"] - counts["refracted"]
    return {"primary": primary, **counts} if found["rays"] else {}


def _dies_with_parent() -> list[str]:
    setpriv = shutil.which("setpriv")
    return [setpriv, "--pdeathsig", "KILL", "--"] if setpriv else []


def _wait(
    child: subprocess.Popen[bytes], deadline: float | None, said: Path, progress: Progress | None
) -> int | None:
    """Return the exit status, None after a timeout; what `progress` raises goes through."""
    while True:
        try:
            return child.wait(_TICK_S)
        except subprocess.TimeoutExpired:
            pass
        if deadline is not None and time.monotonic() > deadline:
            return None
        if progress is not None:
            progress(_fraction(said))


def _end(child: subprocess.Popen[bytes]) -> None:
    """Kill whatever is left of the child's process group and collect it."""
    with contextlib.suppress(ProcessLookupError):
        os.killpg(child.pid, signal.SIGKILL)
    child.wait()


def _fraction(said: Path) -> float:
    with said.open("rb") as messages:
        messages.seek(max(0, said.stat().st_size - 200))
        last = _PROGRESS.findall(messages.read())
    return int(last[-1][0]) / max(1, int(last[-1][1])) if last else 0.0


def _readable(raw: bytes, directory: Path) -> str:
    text = raw.decode("ascii", "replace").replace("\r", "\n").replace(f"{directory}{os.sep}", "")
    lines = (line.rstrip() for line in text.splitlines())
    return "\n".join(line for line in lines if line and not _NOISE.match(line))


def _fault(text: str) -> str:
    """Pick the lines that tell what went wrong, the program's own words."""
    lines = text.splitlines()
    telling = [line.strip() for line in lines if _FAULT.search(line)] or lines[-1:]
    return "; ".join(telling[:3]) or "no message"
