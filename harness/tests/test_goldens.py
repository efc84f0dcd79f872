"""Goldens on disk: whole, belonging together, and never in the place of another file."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from crosstrace.harness.fingerprint import Fingerprint
from crosstrace.harness.goldens import SCHEMA, Golden, Reference, located
from crosstrace.harness.names import slug
from crosstrace.harness.sources import all_packaged_names, find_one
from crosstrace.translators.errors import UsageError

#: All goldens together.
LARGEST_BYTES = 20_000_000


def golden(**about: Any) -> Golden:
    """Return a golden of 4 x 6 pixels with a lane that has classes and one that has none."""
    rng = np.random.default_rng(1)
    classes = np.zeros((4, 6), np.uint8)
    classes[2, 3] = 3
    lanes = [
        {"name": "a", "status": "ok"},
        {"name": "b", "status": "ok"},
        {"name": "c", "status": "unsupported"},
    ]
    plain = {"schema": SCHEMA, "scene": {"v_res": 4, "h_res": 6}, "lanes": lanes,
             "trees_sha256": "0" * 64, "history": [{"reason": "so it is"}]}  # fmt: skip
    print_ = Fingerprint(
        rng.random((2, 3, 3)), rng.integers(0, 1 << 63, (2, 3), np.uint64),
        rng.integers(0, 1 << 63, 4, np.uint64), rng.integers(0, 1 << 63, 6, np.uint64), "0" * 64,
    )  # fmt: skip
    return Golden({**plain, **about}, print_, {"a": np.zeros((4, 6), np.uint8), "b": classes})


def test_a_golden_comes_back_to_the_last_bit(tmp_path: Path) -> None:
    """In a folder that is made for it; a lane of equal pixels alone costs nothing."""
    reference, wrote = Reference(tmp_path / "new/folder", False), golden()
    assert reference.read("x") is None
    size = reference.write("x", wrote)
    read = reference.read("x")
    assert read is not None
    assert size == sum(p.stat().st_size for p in (tmp_path / "new/folder").iterdir())
    for name in ("image", "trees", "row_digests", "column_digests", "sha256"):
        a, b = getattr(read.fingerprint, name), getattr(wrote.fingerprint, name)
        assert np.array_equal(a, b) and np.asarray(a).dtype == np.asarray(b).dtype
    assert {lane: array.tolist() for lane, array in read.classes.items()} == {
        lane: array.tolist() for lane, array in wrote.classes.items()
    }
    with np.load(tmp_path / "new/folder/x.npz") as data:
        assert "classes_0" not in data and "classes_1" in data
    assert read.reason == "so it is"


def test_the_same_golden_is_the_same_bytes(tmp_path: Path) -> None:
    """Files under version control change only where a result did."""
    for folder in ("a", "b"):
        Reference(tmp_path / folder, False).write("x", golden())
    for name in ("x.npz", "x.json"):
        assert (tmp_path / "a" / name).read_bytes() == (tmp_path / "b" / name).read_bytes()


@pytest.mark.parametrize("what", ["image.npz", "other.json", "list.json", "text.json"])
def test_a_file_that_is_no_golden_is_neither_read_nor_overwritten(
    tmp_path: Path, what: str
) -> None:
    """A user's own file of that name stays as it was."""
    name, _, suffix = what.partition(".")
    text = {"other": '{"schema": "mine"}', "list": "[1]", "text": "not JSON"}.get(name, "")
    file = tmp_path / f"x.{suffix}"
    file.write_text(text)
    reference = Reference(tmp_path, False)
    for do in (lambda: reference.read("x"), lambda: reference.write("x", golden())):
        with pytest.raises(UsageError, match=r"expected .*, found|expected x\.json"):
            do()
    assert [p.name for p in tmp_path.iterdir()] == [file.name] and file.read_text() == text


def test_arrays_of_another_golden_are_refused(tmp_path: Path) -> None:
    """The JSON names the hash of its arrays: an interrupted or half-copied golden is told."""
    reference, one = Reference(tmp_path, False), golden()
    reference.write("x", one)
    reference.write("y", replace(one, classes={}))
    (tmp_path / "y.npz").replace(tmp_path / "x.npz")
    with pytest.raises(UsageError, match=r"x\.npz: expected the arrays that x\.json names"):
        reference.read("x")
    with pytest.raises(UsageError, match=r"y\.npz: cannot be read"):
        reference.read("y")


def test_classes_of_another_size_are_refused(tmp_path: Path) -> None:
    """Edited files end in words."""
    reference = Reference(tmp_path, False)
    reference.write("x", golden(scene={"v_res": 5, "h_res": 6}))
    with pytest.raises(UsageError, match="expected a golden, found"):
        reference.read("x")


def test_the_goldens_of_an_installed_package_are_not_written_to(tmp_path: Path) -> None:
    """Only a checkout keeps them; the message names the way out."""
    with pytest.raises(UsageError, match="--reference"):
        Reference(tmp_path / "site-packages/crosstrace/reference", True).write("x", golden())
    assert not list(tmp_path.iterdir())


def test_every_packaged_scene_has_a_golden_of_itself() -> None:
    """Of the numbers that the scene has now, accepted with a reason, and all of them small."""
    reference = located(None)
    goldens = list(reference.folder.glob("*.json"))
    if not goldens:
        pytest.skip("there are no packaged goldens: crosstrace bless --all makes them")
    names = all_packaged_names()
    assert sorted(path.stem for path in goldens) == sorted(slug(name, set()) for name in names)
    for name in names:
        kept = reference.read(name)
        assert kept is not None
        assert kept.about["scene"]["sha256"] == find_one(name).scene.sha256
        assert json.loads(json.dumps(kept.about))["history"] and kept.reason
    assert sum(path.stat().st_size for path in reference.folder.iterdir()) <= LARGEST_BYTES
