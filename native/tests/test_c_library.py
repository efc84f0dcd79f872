"""The C tests, each a program of its own, built plain and under the sanitizers."""

from __future__ import annotations

import re
import shutil
import subprocess
from pathlib import Path

import pytest

NATIVE = Path(__file__).resolve().parents[1]
BUILDS = {
    "O3": [],
    "O0 with AddressSanitizer and UBSan": [
        "-DCT_SANITIZE=address,undefined",
        "-DCMAKE_BUILD_TYPE=Debug",
    ],
    "O3 with AddressSanitizer and UBSan": ["-DCT_SANITIZE=address,undefined"],
}


def _run(*command: str | Path) -> str:
    done = subprocess.run(
        list(map(str, command)), capture_output=True, text=True, timeout=500, check=False
    )
    assert done.returncode == 0, f"{command}\n{done.stdout}\n{done.stderr}"
    return done.stdout


def _build(folder: Path, *settings: str) -> Path:
    if not shutil.which("cmake") or not (shutil.which("cc") or shutil.which("gcc")):
        pytest.skip("cmake and a C compiler are needed to build the C tests")
    _run("cmake", "-S", NATIVE, "-B", folder, "-DCT_WERROR=ON", *settings)
    _run("cmake", "--build", folder, "--parallel", "2")
    return folder


@pytest.mark.parametrize("build", BUILDS)
def test_the_c_tests_pass(tmp_path: Path, build: str) -> None:
    """Warnings are errors, and every C test and corpus input passes in every build."""
    folder = _build(tmp_path, *BUILDS[build])
    listed = _run("ctest", "--test-dir", folder, "--output-on-failure")
    passed = re.search(r"100% tests passed, 0 tests failed out of (\d+)", listed)
    assert passed and int(passed[1]) >= 6


def test_the_library_exports_only_its_own_prefix(tmp_path: Path) -> None:
    """Every name that a program could clash with begins with ct_."""
    folder = _build(tmp_path)
    library = next(folder.rglob("libct_shared.*"))
    lines = _run("nm", "-D", "--defined-only", library).split("\n")
    exported = {line.split()[-1] for line in lines if line}
    assert exported
    assert all(name.startswith("ct_") for name in exported), exported


def test_the_library_neither_prints_nor_exits(tmp_path: Path) -> None:
    """No function of the library calls for standard output or ends the process."""
    folder = _build(tmp_path)
    listed = _run("nm", next(folder.rglob("libct.a")))
    undefined = {line.split()[-1] for line in listed.split("\n") if " U " in line}
    assert not undefined & {"printf", "puts", "fprintf", "exit", "abort", "stdout", "stderr"}
