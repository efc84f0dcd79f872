"""What a word for a scene may name: a file, a folder, a packaged scene."""

from __future__ import annotations

import json
from importlib.resources import files
from pathlib import Path

import pytest
from command_line import SCENE, scene_file

from crosstrace.harness.sources import find, find_one, from_scenes, packaged_names
from crosstrace.translators.errors import SceneError, UsageError


def test_a_file_is_one_scene_under_its_own_name(tmp_path: Path) -> None:
    """The name is that of the file without its suffix."""
    source = find_one(str(scene_file(tmp_path)))
    assert (source.name, source.packaged) == ("tiny", False)
    assert source.scene.shape == (12, 16, 3)


def test_a_folder_is_its_text_files_in_order(tmp_path: Path) -> None:
    """Other files of the folder are not looked at."""
    for name in ("b.txt", "a.txt", "c.txt", "notes.md"):
        scene_file(tmp_path, name=name)
    assert [source.name for source in find([str(tmp_path)])] == ["a", "b", "c"]


def test_nothing_named_is_every_packaged_scene_in_the_order_of_the_index() -> None:
    """The index has 18 scenes, whose names, deliveries and files agree with what is read."""
    index = json.loads(
        (files("crosstrace.scenes") / "course" / "index.json").read_text(encoding="utf-8")
    )
    found = find()
    assert [source.name for source in found] == [entry["name"] for entry in index]
    assert len(found) == 18
    assert [source.scene.delivery for source in found] == [entry["delivery"] for entry in index]
    assert all(source.packaged and source.title for source in found)


def test_a_packaged_scene_is_found_by_its_name_unless_a_file_has_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What lies in the user's directory comes first."""
    name = packaged_names()[0]
    monkeypatch.chdir(tmp_path)
    assert find_one(name).packaged
    scene_file(tmp_path, name=name)
    assert not find_one(name).packaged


def test_scenes_of_one_name_are_told_apart(tmp_path: Path) -> None:
    """Two folders may hold a file of the same name."""
    for folder in ("a", "b"):
        (tmp_path / folder).mkdir()
        scene_file(tmp_path / folder)
    found = find([str(tmp_path / "a"), str(tmp_path / "b")])
    assert len({source.name for source in found}) == 2


def test_size_and_delivery_override_the_file(tmp_path: Path) -> None:
    """The resolution changes with the pixel size; a delivery that does not fit is an error."""
    path = str(scene_file(tmp_path))
    scene, large = find_one(path).scene, find_one(path, size=(24, 32)).scene
    assert large.shape == (24, 32, 3)
    assert large.pixel_size == pytest.approx(scene.pixel_size / 2)
    with pytest.raises(SceneError) as caught:
        find_one(path, delivery=1)
    assert caught.value.line > 0


@pytest.mark.parametrize("prepare", ["nothing", "empty folder", "two scenes", "bad scene"])
def test_what_names_no_scene_is_refused(tmp_path: Path, prepare: str) -> None:
    """Each refusal names what was looked for and what was found."""
    word = str(tmp_path if prepare != "nothing" else tmp_path / "nowhere")
    if prepare == "two scenes":
        scene_file(tmp_path, name="a.txt")
        scene_file(tmp_path, name="b.txt")
    if prepare == "bad scene":
        scene_file(tmp_path, SCENE[:40])
    with pytest.raises((UsageError, SceneError), match=r"expected .*, found ") as caught:
        find_one(word)
    assert isinstance(caught.value, SceneError) == (prepare == "bad scene")


def test_a_hard_scene_is_found_by_its_name_too() -> None:
    """The numerically hard scenes are packaged; a run without words leaves them out."""
    (source,) = find(["nested-glass"])
    assert source.scene.max_depth == 8 and not source.packaged
    assert "nested-glass" not in packaged_names()


def test_a_packaged_scene_given_as_a_scene_keeps_its_title() -> None:
    """From Python, a loaded packaged scene is named in the report as on the command line."""
    for name in ("vidro4", "nested-glass"):
        (source,) = find([name])
        (again,) = from_scenes([source.scene])
        assert again == source and again.title


def test_a_folder_s_index_says_what_is_expected_of_its_scenes(tmp_path: Path) -> None:
    """By name or by file; a scene that it leaves out is to agree."""
    for name in ("a.txt", "b.txt", "c.txt"):
        scene_file(tmp_path, name=name)
    expected = {"verdict": "disagree", "blame": ["povray"], "cause": "known"}
    index = [{"file": "a.txt", "expected": expected}, {"name": "c", "title": "Third"}]
    (tmp_path / "index.json").write_text(json.dumps(index))
    a, b, c = find([str(tmp_path)])
    assert (a.expected, b.expected, c.expected) == (expected, None, None)
    assert c.title == "Third"


@pytest.mark.parametrize(
    ("text", "word"),
    [
        ("{", "JSON"),
        ("{}", "a list of scenes"),
        ('[{"title": "nameless"}]', "the name or file"),
        ('[{"name": "a", "expected": {"verdict": "fine", "blame": [], "cause": ""}}]', "a verdict"),
        ('[{"name": "a", "expected": {"verdict": "agree", "blame": "x"}}]', "a verdict"),
    ],
)
def test_a_malformed_index_is_refused_by_name(tmp_path: Path, text: str, word: str) -> None:
    """The message says which file, and what belongs there."""
    scene_file(tmp_path)
    (tmp_path / "index.json").write_text(text)
    with pytest.raises(UsageError, match=rf"index.json: expected .*{word}"):
        find([str(tmp_path)])
