"""The probe: it reports what is missing, survives a library that aborts, and asks only once."""

from __future__ import annotations

import importlib.util
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from crosstrace.translators.errors import RendererMissingError
from crosstrace.translators.mitsuba import probe as probing


@pytest.fixture(autouse=True)
def fresh() -> Iterator[None]:
    """Forget what was found before and after each test."""
    probing.probe.cache_clear()
    yield
    probing.probe.cache_clear()


def child(monkeypatch: pytest.MonkeyPatch, program: str) -> None:
    """Let the probe's child run another program."""
    monkeypatch.setattr(probing, "_CHILD", program)


def test_versions_are_reported(works: None) -> None:
    """Where Mitsuba works, its version, Dr.Jit's and LLVM's are known."""
    found = probing.probe()
    assert found.available
    assert found.version.startswith("3.")
    assert set(found.details) == {"drjit", "llvm"}


def test_a_missing_package_has_a_remedy(monkeypatch: pytest.MonkeyPatch) -> None:
    """Without the package, the probe names the line that installs it."""
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    found = probing.probe()
    assert not found.available
    assert "pip install" in found.remedy


def test_a_missing_llvm_has_a_remedy(
    works: None, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """Without LLVM, the probe names Debian's package."""
    monkeypatch.setenv("DRJIT_LIBLLVM_PATH", str(tmp_path / "absent.so"))
    found = probing.probe()
    assert not found.available
    assert found.version == ""
    assert found.remedy == "apt-get install libllvm19"
    assert "LLVM" in found.reason


def test_an_aborting_llvm_harms_only_the_child(monkeypatch: pytest.MonkeyPatch) -> None:
    """LLVM 15 and 16 end the process with SIGABRT; the probe reports it."""
    child(monkeypatch, "import os; os.abort()")
    found = probing.probe()
    assert not found.available
    assert "aborts" in found.reason
    assert found.remedy == "apt-get install libllvm19"


def test_wrong_numbers_are_no_pass(monkeypatch: pytest.MonkeyPatch) -> None:
    """A kernel that runs and computes nonsense does not count as working."""
    child(monkeypatch, 'print(\'{"good": false, "mitsuba": "3"}\')')
    assert not probing.probe().available


def test_a_hanging_child_is_given_up(monkeypatch: pytest.MonkeyPatch) -> None:
    """The child has a time limit."""
    child(monkeypatch, "import time; time.sleep(60)")
    monkeypatch.setattr(probing, "CHILD_LIMIT_S", 0.2)
    assert "could not be tried" in probing.probe().reason


def test_the_child_is_started_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """What was found is kept for the life of the process."""
    started = []
    run = subprocess.run

    def count(*args: Any, **options: Any) -> Any:
        started.append(args)
        return run([sys.executable, "-c", "raise SystemExit(1)"], **options)

    monkeypatch.setattr(subprocess, "run", count)
    assert probing.probe() == probing.probe()
    assert len(started) <= 1


@pytest.mark.parametrize("version", [(15, 0, 7), (16, 0, 6)])
def test_a_process_that_would_abort_is_not_entered(version: tuple[int, ...]) -> None:
    """Rendering looks at the version alone and raises instead."""
    with pytest.raises(RendererMissingError, match="libllvm19"):
        probing.refuse_bad_llvm(version)


def test_good_versions_pass() -> None:
    """LLVM 19 is accepted."""
    probing.refuse_bad_llvm((19, 1, 7))
