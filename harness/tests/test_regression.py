"""Scenes held against their goldens: what passes, what fails, and what is incomplete."""

from __future__ import annotations

import shutil
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from small_runs import sky

from crosstrace.harness.goldens import Reference, located
from crosstrace.harness.jobs import WorkerPool
from crosstrace.harness.regression import CREATED, bless, check, exit_status
from crosstrace.harness.session import RunOptions
from crosstrace.harness.sources import Source, all_packaged_names, find, from_scenes
from crosstrace.translators.errors import UsageError

MOODY, PLAIN = "fake_lanes:Moody", "fake_lanes:Plain"
ABSENT, REFUSING = "fake_lanes:Absent", "fake_lanes:Refusing"

Check = dict[str, Any]
Run = Callable[..., Check]
Accept = Callable[..., list[Check]]
Mood = Callable[[float, int], None]


def sources(background: float = 128, rows: int = 12) -> list[Source]:
    """Return a scene of its background alone, of which the fake lanes are right."""
    scene = sky(v_res=rows, background=[0, background, 255], name="sky")
    return from_scenes([scene])


def how(*lanes: str) -> RunOptions:
    return RunOptions(lanes or (PLAIN, MOODY), jobs=1, timeout_s=60.0)


@pytest.fixture(scope="module")
def mood_file(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """Give the file that the second lane reads, wherever it runs."""
    file = tmp_path_factory.mktemp("mood") / "mood"
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("CROSSTRACE_TEST_MOOD", str(file))
        yield file


@pytest.fixture(scope="module")
def workers(mood_file: Path) -> Iterator[WorkerPool]:
    """Give one pool to all tests of this file: starting workers is what takes time here."""
    with WorkerPool(1, threads=1) as pool:
        yield pool


@pytest.fixture
def mood(mood_file: Path) -> Iterator[Mood]:
    """Return what makes the second lane wrong by a number in so many pixels."""

    def set_mood(add: float, pixels: int) -> None:
        mood_file.write_text(f"{add} {pixels}")

    set_mood(0.0, 0)
    yield set_mood
    set_mood(0.0, 0)


@pytest.fixture
def held(workers: WorkerPool, mood: Mood) -> Run:
    """Return `check`, in the workers of this file."""
    return partial(check, executor=workers)


@pytest.fixture
def accept(workers: WorkerPool, mood: Mood) -> Accept:
    """Return `bless`, in the workers of this file."""
    return partial(bless, executor=workers)


@pytest.fixture
def reference(tmp_path: Path, accept: Accept) -> Reference:
    """Give a folder with the golden of the scene as the fake lanes rightly draw it."""
    made = Reference(tmp_path / "goldens", False)
    (done,) = accept(sources(), made, "the sky is blue", how())
    assert done["status"] == "new"
    return made


def files(reference: Reference) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in reference.folder.iterdir()}


def only(checked: Check) -> Check:
    (scene,) = checked["scenes"]
    found: Check = scene
    return found


def test_a_scene_as_it_was_passes_without_a_note(reference: Reference, held: Run) -> None:
    """And leaves the golden as it was."""
    before = files(reference)
    checked = held(sources(), reference, how())
    assert (checked["status"], exit_status(checked)) == ("pass", 0)
    assert only(checked)["changes"] == []
    assert only(checked)["reason"] == "the sky is blue"
    assert files(reference) == before


def test_a_missing_golden_is_made_and_fails_once(tmp_path: Path, held: Run, accept: Accept) -> None:
    """The next check passes, and the golden says that nobody gave a reason."""
    reference = Reference(tmp_path / "goldens", False)
    first = held(sources(), reference, how())
    assert (only(first)["status"], exit_status(first)) == ("fail", 1)
    assert "there was no golden: one was made" in only(first)["changes"][0]["text"]
    second = held(sources(), reference, how())
    assert only(second)["status"] == "pass" and only(second)["reason"] == CREATED
    (done,) = accept(sources(), reference, "looked at it", how())
    assert done["status"] == "blessed"
    golden = reference.read("sky")
    assert golden is not None
    assert [entry["reason"] for entry in golden.about["history"]] == [CREATED, "looked at it"]


def test_a_missing_golden_is_not_made_of_a_wrong_image(
    tmp_path: Path, mood: Mood, held: Run
) -> None:
    """A disagreement needs somebody's reason before it is what is expected."""
    mood(0.5, 3)
    reference = Reference(tmp_path / "goldens", False)
    for _ in range(2):
        checked = held(sources(), reference, how())
        assert only(checked)["status"] == "fail"
        assert "the verdict is disagree" in only(checked)["changes"][0]["text"]
    assert not reference.folder.exists()


def test_one_wrong_pixel_fails_and_is_named(reference: Reference, mood: Mood, held: Run) -> None:
    """With its lane, its classes, and the verdict that it makes."""
    mood(0.5, 1)
    scene = only(held(sources(), reference, how()))
    assert scene["status"] == "fail"
    texts = {(change["lane"], change["text"]) for change in scene["changes"] if change["fails"]}
    assert ("", f"agree -> disagree (blamed: {MOODY})") in texts
    assert (MOODY, "1 pixel now wrong: (0, 0) equal -> wrong") in texts
    assert all(change["lane"] in ("", MOODY) for change in scene["changes"])


def test_a_blessed_defect_passes_until_it_grows_or_goes(
    reference: Reference, mood: Mood, held: Run, accept: Accept
) -> None:
    """What was accepted with a reason is what is expected, either way."""
    mood(0.5, 20)
    (done,) = accept(sources(), reference, "a known defect of that lane", how())
    assert (done["status"], done["verdict"], done["blame"]) == ("blessed", "disagree", [MOODY])
    assert only(held(sources(), reference, how()))["status"] == "pass"
    for pixels in (0, 21):
        mood(0.5, pixels)
        assert only(held(sources(), reference, how()))["status"] == "fail"


def test_an_absent_lane_is_incomplete_and_never_a_pass(
    reference: Reference, mood: Mood, held: Run, accept: Accept
) -> None:
    """The others are compared all the same, and a failure wins."""
    accept(sources(), reference, "three lanes", how(PLAIN, MOODY))
    golden = reference.read("sky")
    assert golden is not None
    # As if the lane that is absent here had been there then.
    lanes = [*golden.about["lanes"], {**golden.about["lanes"][0], "name": ABSENT}]
    about = {**golden.about, "lanes": lanes}
    reference.write("sky", type(golden)(about, golden.fingerprint, golden.classes))
    checked = held(sources(), reference, how(PLAIN, MOODY, ABSENT))
    assert (checked["status"], exit_status(checked)) == ("incomplete", 3)
    assert [lane["lane"] for lane in only(checked)["absent"]] == [ABSENT]
    assert "no such program" in only(checked)["absent"][0]["message"]
    assert not any(change["fails"] for change in only(checked)["changes"])
    mood(0.5, 1)
    assert exit_status(held(sources(), reference, how(PLAIN, MOODY, ABSENT))) == 1


def test_nothing_is_blessed_or_made_without_every_lane(
    tmp_path: Path, held: Run, accept: Accept
) -> None:
    """An incomplete result is no golden."""
    reference = Reference(tmp_path / "goldens", False)
    (done,) = accept(sources(), reference, "why not", how(PLAIN, ABSENT))
    assert done["status"] == "incomplete" and "no such program" in done["message"]
    scene = only(held(sources(), reference, how(PLAIN, ABSENT)))
    assert scene["status"] == "fail" and "without every renderer" in scene["changes"][0]["text"]
    assert not reference.folder.exists()


def test_what_a_lane_declares_unsupported_is_part_of_the_golden(
    reference: Reference, tmp_path: Path, held: Run, accept: Accept
) -> None:
    """It passes as long as it stays so; one that gave an image before fails."""
    other = Reference(tmp_path / "other", False)
    (done,) = accept(sources(), other, "it says so itself", how(PLAIN, REFUSING))
    assert done["status"] == "new"
    assert only(held(sources(), other, how(PLAIN, REFUSING)))["status"] == "pass"
    scene = only(held(sources(), reference, how(PLAIN, MOODY, REFUSING)))
    assert scene["status"] == "fail"
    assert [c["lane"] for c in scene["changes"] if c["fails"]] == [REFUSING]


def test_fewer_lanes_are_compared_by_themselves(
    reference: Reference, mood: Mood, held: Run, accept: Accept
) -> None:
    """A lane that is not asked for is not missed, nor is its verdict."""
    mood(0.5, 20)
    accept(sources(), reference, "a known defect of that lane", how())
    assert only(held(sources(), reference, how(PLAIN)))["status"] == "pass"


def test_another_scene_is_told_and_nothing_else(reference: Reference, held: Run) -> None:
    """The numbers of the scene changed, or its size."""
    for other, said in ((sources(129), "of other numbers"), (sources(rows=13), "at 12x16 instead")):
        scene = only(held(other, reference, how()))
        (change,) = scene["changes"]
        assert scene["status"] == "fail" and change["what"] == "scene" and said in change["text"]


def test_a_changed_reference_image_fails(reference: Reference, held: Run) -> None:
    """The native tracer's own value is compared too, whichever lanes are asked for."""
    golden = reference.read("sky")
    assert golden is not None
    golden.fingerprint.image[4, 5, 0] += 1e-6
    reference.write("sky", golden)
    scene = only(held(sources(), reference, how()))
    (change,) = scene["changes"]
    assert scene["status"] == "fail"
    assert (change["lane"], change["what"], change["pixels"]) == ("native", "reference", ((4, 5),))


def test_another_processor_is_told_beside_what_changed(
    reference: Reference, held: Run, mood: Mood
) -> None:
    """And not at all where nothing did."""
    golden = reference.read("sky")
    assert golden is not None
    made_on = {**golden.about["environment"], "cpu": "another one"}
    about = {**golden.about, "environment": made_on}
    reference.write("sky", replace(golden, about=about))
    assert only(held(sources(), reference, how()))["changes"] == []
    mood(0.5, 1)
    scene = only(held(sources(), reference, how()))
    assert scene["status"] == "fail"
    assert "another processor: another one -> " in scene["changes"][-1]["text"]


def test_bless_leaves_alone_what_came_out_as_before(reference: Reference, accept: Accept) -> None:
    """So that blessing everything rewrites only what changed."""
    before = files(reference)
    (done,) = accept(sources(), reference, "again", how())
    assert done["status"] == "unchanged"
    assert files(reference) == before


def test_bless_wants_a_reason(tmp_path: Path, accept: Accept) -> None:
    """Blanks are none."""
    with pytest.raises(UsageError, match="expected a reason"):
        accept(sources(), Reference(tmp_path, False), " \n ", how())


def test_two_scenes_of_one_golden_are_refused(tmp_path: Path, held: Run) -> None:
    """Two files of one name in two folders, before anything is rendered."""
    doubled = from_scenes([sources()[0].scene, sources(100)[0].scene])
    with pytest.raises(UsageError, match="one scene a golden"):
        held(doubled, Reference(tmp_path, False), how())


def test_scenes_of_ones_own_have_no_place_among_the_packaged_goldens(held: Run) -> None:
    """The message names the option."""
    with pytest.raises(UsageError, match="--reference"):
        held(sources(), located(None), how())


@pytest.fixture(scope="module")
def packaged(tmp_path_factory: pytest.TempPathFactory) -> tuple[list[Source], Reference]:
    """Give three packaged scenes at a small size with goldens by every renderer."""
    found = find(["polonia", "eclipse", "nested-glass"], size=(48, 64))
    reference = Reference(tmp_path_factory.mktemp("goldens"), False)
    done = bless(found, reference, "as rendered a moment ago", RunOptions())
    assert {scene["status"] for scene in done} == {"new"}
    return found, reference


def test_every_renderer_comes_out_the_same_again(packaged: tuple[list[Source], Reference]) -> None:
    """Three packaged scenes, one of each kind: no change, not even a note."""
    checked = check(*packaged, RunOptions(jobs=1))
    assert [scene["changes"] for scene in checked["scenes"]] == [[], [], []]
    assert checked["status"] == "pass"


def test_another_scene_under_the_same_name_does_not_pass(
    packaged: tuple[list[Source], Reference],
) -> None:
    """A light that moved is another scene, so even renderers that agree are not accepted."""
    found, reference = packaged
    lights = np.array(found[1].scene.lights)
    lights[:, 3:] += 1e-3
    moved = replace(found[1], scene=replace(found[1].scene, lights=lights, checked=False))
    scene = only(check([moved], reference, RunOptions()))
    assert scene["status"] == "fail" and scene["changes"][0]["what"] == "scene"


@pytest.fixture
def goldens(tmp_path: Path) -> Reference:
    """Give a copy of the packaged goldens: a check that finds one missing would make it."""
    kept = located(None).folder
    if not list(kept.glob("*.json")):
        pytest.skip("there are no packaged goldens: crosstrace bless --all makes them")
    return Reference(Path(shutil.copytree(kept, tmp_path / "reference")), False)


def test_the_packaged_goldens_hold_for_a_scene_of_each_kind(goldens: Reference) -> None:
    """The real suite, on three of its scenes and every renderer."""
    checked = check(find(["japao", "eye-on-plane", "nested-glass"]), goldens, RunOptions())
    assert checked["status"] == "pass", checked["scenes"]


@pytest.mark.slow
@pytest.mark.timeout(3600)
def test_the_whole_suite_passes(goldens: Reference) -> None:
    """Every packaged scene, course and hard, against its golden."""
    checked = check(find(all_packaged_names()), goldens, RunOptions())
    failed = [scene for scene in checked["scenes"] if scene["status"] != "pass"]
    assert checked["status"] == "pass", failed
