"""The course's text format, read and written."""

from __future__ import annotations

import locale
import tracemalloc
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from crosstrace.translators.course import dumps, load, parse
from crosstrace.translators.errors import SceneError, UsageError
from crosstrace.translators.scene import Scene

HEADER = "4 6\n0.5 2\n0 0 5\n0 0 0\n0 1 0\n10 20 30\n"

numbers = st.floats(-1e100, 1e100)
colors = st.floats(0, 255)
coefficients = st.floats(0, 1)
positive = st.floats(1e-100, 1e100)
nearby = st.floats(-1e3, 1e3)
triples = st.tuples(numbers, numbers, numbers)


@st.composite
def scenes(draw: Any) -> Scene:
    """Draw any valid scene of any delivery, with extreme numbers."""
    delivery = draw(st.integers(1, 3))
    n = draw(st.integers(0, 4))
    m = 0 if delivery == 1 else draw(st.integers(0, 3))
    material = np.tile([1.0 if delivery == 1 else 0.0, 0, 0, 1, 0, 0, 1], (n, 1))
    for row in material:
        if delivery > 1:
            row[:4] = [draw(coefficients) for _ in range(3)] + [draw(positive)]
        if delivery > 2:
            row[4:] = draw(coefficients), draw(coefficients), draw(positive)
    kind = np.array([draw(st.integers(0, 1)) for _ in range(n)], np.uint8)
    geometry = np.zeros((n, 6))
    for is_plane, row in zip(kind, geometry, strict=True):
        row[:3] = draw(triples)
        row[3:] = (0.0, draw(positive), draw(numbers)) if is_plane else (draw(positive), 0, 0)
    return Scene(
        delivery=delivery, v_res=draw(st.integers(1, 9)), h_res=draw(st.integers(1, 9)),
        pixel_size=draw(positive), screen_distance=draw(positive),
        eye=np.array([draw(nearby), draw(nearby), 2.0]), target=np.array([2e3, 0.0, draw(numbers)]),
        up=np.array([0.0, 1.0, -0.0]) if draw(st.booleans()) else np.array([0.0, 1.0, 0.5]),
        background=np.array([draw(colors) for _ in range(3)]),
        max_depth=draw(st.integers(0, 2**31 - 1)) if delivery == 3 else 0,
        kind=kind,
        color=np.array([[draw(colors) for _ in range(3)] for _ in range(n)]).reshape(n, 3),
        material=material, geometry=geometry,
        ambient=np.array([draw(colors) if delivery > 1 else 255.0 for _ in range(3)]),
        lights=np.array([[*(draw(colors) for _ in range(3)), *draw(triples)] for _ in range(m)])
        .reshape(m, 6),
    )  # fmt: skip


@given(scenes())
@settings(max_examples=150, deadline=None)
def test_a_written_scene_reads_back_equal_to_the_last_bit(scene: Scene) -> None:
    """write(read(x)) == x for every delivery, with numbers of any size and −0."""
    again = parse(dumps(scene))
    assert again == scene
    assert again.sha256 == scene.sha256


@pytest.mark.parametrize(
    "text",
    [
        HEADER.replace("\n", "\r\n") + "1\r\n255 0 0 * 0 0 0 1\r\n",
        "\ufeff" + HEADER + "\n\n\t1\n255 0 0 *\t0 0 0 1",
        HEADER.replace("4 6", "4.0 6.0").replace("0.5 2", "5e-1 +2.") + "1 255 0 0*0 0 -0 1",
    ],
)
def test_the_hash_does_not_depend_on_spelling(text: str) -> None:
    """A BOM, CR LF, tabs, blank lines, 480.0 for 480 and −0 for 0 give the same scene hash."""
    assert parse(text).sha256 == parse(HEADER + "1\n255 0 0 * 0 0 0 1\n").sha256


def test_the_hash_depends_on_every_number() -> None:
    """Changing any single number of a scene changes its hash."""
    words = (HEADER + "3 1 2 3 4 .1 .2 .3 4 .5 .6 1.5 * 7 8 9 1 5 6 7 1 9 9 9 1 2 3").split()
    signs_and_counts = {16, 17, 28, 36}
    hashes = {parse(" ".join(words)).sha256}
    for i in range(len(words)):
        if i in signs_and_counts:
            continue
        changed = [*words]
        changed[i] = str(float(words[i]) + (1 if i < 2 else 0.0625))
        hashes.add(parse(" ".join(changed)).sha256)
    assert len(hashes) == 1 + len(words) - len(signs_and_counts)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("4 6\n0.5 two\n", "bad.txt:2:5: expected a number (the distance d), found 'two'"),
        ("", "bad.txt:1:1: expected a number (v_res), found end of file"),
        (
            HEADER + "1\n255 0 0 * 0 0 0 1\n1\n",
            "bad.txt:9:1: expected end of file, found '1'",
        ),
        (
            HEADER + "1\n255 0 0 * 0 0 0 -1\n",
            "bad.txt:8:17: expected a number greater than 0 (the radius), found '-1'",
        ),
    ],
)
def test_a_malformed_file_is_refused_with_its_place(
    tmp_path: Path, text: str, message: str
) -> None:
    """The error is file:line:column: expected …, found …."""
    file = tmp_path / "bad.txt"
    file.write_text(text)
    with pytest.raises(SceneError) as error:
        load(file)
    assert str(error.value) == f"{tmp_path}/{message}"


@given(st.binary(max_size=200))
def test_no_bytes_at_all_break_the_reader(data: bytes) -> None:
    """Any bytes either read as a scene or are refused with a place."""
    try:
        parse(data)
    except SceneError as error:
        assert error.line >= 1 and error.column >= 1


def test_every_prefix_of_a_file_is_refused(tmp_path: Path) -> None:
    """A file cut anywhere inside its last number or before never reads as another scene.

    The exceptions are cuts that leave a shorter last number, which nobody can tell.
    """
    text = HEADER + "3\n1\n1 2 3 .1 .2 .3 4 .5 .6 1.5 * 7 8 9 1\n5 6 7\n1\n9 9 9 1 2 375\n"
    whole = parse(text)
    for n in range(text.rindex("375")):
        with pytest.raises(SceneError):
            parse(text[:n])
    assert parse(text.rstrip()) == whole


def test_a_missing_file_is_a_usage_error(tmp_path: Path) -> None:
    """A file that cannot be read is refused without a traceback's worth of detail."""
    with pytest.raises(UsageError, match="No such file"):
        load(tmp_path / "nowhere.txt")


def test_a_given_delivery_overrides_what_the_text_says() -> None:
    """The number of numbers decides unless the caller does."""
    text = HEADER + "0\n255 255 255\n0\n"
    assert parse(text).delivery == 2
    with pytest.raises(SceneError, match="end of file"):
        parse(text, delivery=1)
    with pytest.raises(UsageError, match="delivery 1, 2 or 3"):
        parse(text, delivery=4)


def test_numbers_are_read_whatever_the_locale() -> None:
    """A process that writes 0,5 for 0.5 reads the same scene."""
    before = locale.setlocale(locale.LC_NUMERIC)
    available = [name for name in ("de_DE.UTF-8", "pt_BR.UTF-8", "C.UTF-8") if _set_locale(name)]
    try:
        assert available
        assert parse(HEADER + "0").pixel_size == 0.5
    finally:
        locale.setlocale(locale.LC_NUMERIC, before)


def _set_locale(name: str) -> bool:
    try:
        locale.setlocale(locale.LC_NUMERIC, name)
    except locale.Error:
        return False
    return True


def test_a_million_spheres_are_arrays_and_not_objects() -> None:
    """A file of a million spheres reads into arrays of 129 bytes a sphere, no Python objects."""
    n = 1_000_000
    text = (HEADER + f"{n}\n" + "255 0 0 * 0 1 2 0.5\n" * n).encode()
    tracemalloc.start()
    scene = parse(text)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert len(scene) == n
    assert scene.geometry[-1].tolist() == [0, 1, 2, 0.5, 0, 0]
    arrays = (scene.kind, scene.color, scene.material, scene.geometry)
    assert sum(array.nbytes for array in arrays) == 129 * n
    assert peak < 1_000_000
