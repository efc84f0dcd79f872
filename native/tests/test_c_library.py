"""The C tests, each a program of its own, built plain and under the sanitizers."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
from collections.abc import Callable
from functools import cache
from pathlib import Path

import pytest

from crosstrace.native import _core

NATIVE = Path(__file__).resolve().parents[1]
BUILDS = {
    "O3": [],
    "O0 with AddressSanitizer and UBSan": [
        "-DCT_SANITIZE=address,undefined",
        "-DCMAKE_BUILD_TYPE=Debug",
    ],
    "O3 with AddressSanitizer and UBSan": ["-DCT_SANITIZE=address,undefined"],
}


#: What the tests that trace take as the most of the processor's instruction sets: with each cap the
#: next better set, and all beyond it, is switched off.
CAPS = _core.instructions()


def _run(*command: str | Path, cap: str | None = None) -> str:
    environment = os.environ | ({"CT_TEST_INSTRUCTIONS": cap} if cap else {})
    done = subprocess.run(
        list(map(str, command)), capture_output=True, text=True, timeout=500, check=False,
        env=environment,
    )  # fmt: skip
    assert done.returncode == 0, f"{command}\n{done.stdout}\n{done.stderr}"
    return done.stdout


def _passed(listed: str) -> int:
    found = re.search(r"100% tests passed, 0 tests failed out of (\d+)", listed)
    assert found, listed
    return int(found[1])


def _build(folder: Path, *settings: str) -> Path:
    if not shutil.which("cmake") or not (shutil.which("cc") or shutil.which("gcc")):
        pytest.skip("cmake and a C compiler are needed to build the C tests")
    _run("cmake", "-S", NATIVE, "-B", folder, "-DCT_WERROR=ON", *settings)
    _run("cmake", "--build", folder, "--parallel", "2")
    return folder


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Path]:
    """Return a function that builds one of `BUILDS`, once for all tests."""
    return cache(lambda build: _build(tmp_path_factory.mktemp("build"), *BUILDS[build]))


@pytest.mark.parametrize("build", BUILDS)
def test_the_c_tests_pass(built: Callable[[str], Path], build: str) -> None:
    """Warnings are errors; every C test and corpus input passes in every build.

    The tests that trace also pass with each instruction set of the processor switched off.
    """
    folder = built(build)
    assert _passed(_run("ctest", "--test-dir", folder, "--output-on-failure")) >= 6
    for cap in CAPS[:-1]:
        words = ("ctest", "--test-dir", folder, "--output-on-failure", "-L", "traces")
        assert _passed(_run(*words, cap=cap)) >= 4


def test_a_cap_that_does_not_exist_fails_the_c_tests(built: Callable[[str], Path]) -> None:
    """The test programs do read the cap: otherwise switching sets off would test nothing."""
    folder = built("O3")
    program = next(folder.rglob("test_threads"))
    environment = os.environ | {"CT_TEST_INSTRUCTIONS": "sse9"}
    done = subprocess.run([program], env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 1
    assert "ct_options_set_instructions" in done.stderr


def test_the_library_exports_only_its_own_prefix(built: Callable[[str], Path]) -> None:
    """Every name that a program could clash with begins with ct_."""
    folder = built("O3")
    library = next(folder.rglob("libct_shared.*"))
    lines = _run("nm", "-D", "--defined-only", library).split("\n")
    exported = {line.split()[-1] for line in lines if line}
    assert exported
    assert all(name.startswith("ct_") for name in exported), exported


def test_the_library_neither_prints_nor_exits(built: Callable[[str], Path]) -> None:
    """No function of the library calls for standard output or ends the process."""
    folder = built("O3")
    listed = _run("nm", next(folder.rglob("libct.a")))
    undefined = {line.split()[-1] for line in listed.split("\n") if " U " in line}
    assert not undefined & {"printf", "puts", "fprintf", "exit", "abort", "stdout", "stderr"}
