"""The plugin of pytest, by tests that are run in a pytest of their own."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from command_line import NO_POVRAY, SCENE, python
from small_runs import EMPTY

pytest_plugins = ["pytester"]

#: A scene of its background alone.
OPTIONS = ("-p", "no:cacheprovider", "-p", "no:timeout", "-p", "no:hypothesispytest")


@pytest.fixture
def scenes(pytester: pytest.Pytester, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Give a folder with two scenes, a test beside them, and renderers that can be imported."""
    monkeypatch.syspath_prepend(str(Path(__file__).parent))
    monkeypatch.setenv("PYTHONPATH", str(Path(__file__).parent))
    folder = pytester.mkdir("scenes")
    (folder / "ball.txt").write_text(SCENE)
    (folder / "sky.txt").write_text(EMPTY)
    (folder / "test_other.py").write_text("def test_other():\n    assert True\n")
    (folder / "notes.txt.bak").write_text("no scene")
    return folder


def run(pytester: pytest.Pytester, *words: object) -> pytest.RunResult:
    return pytester.runpytest_subprocess(*OPTIONS, *map(str, words))


def test_nothing_is_collected_without_the_option(pytester: pytest.Pytester, scenes: Path) -> None:
    """A folder with text files is none of the plugin's business, even named."""
    run(pytester, scenes).assert_outcomes(passed=1)
    result = run(pytester, scenes / "sky.txt", "--collect-only", "-q")
    assert not re.search(r"sky\.txt::", result.stdout.str())


def test_the_plugin_loads_nothing_heavy() -> None:
    """It is imported by every pytest of its environment."""
    program = (
        "import sys; before = set(sys.modules)\n"
        "import pytest, crosstrace.harness.pytest_plugin\n"
        "heavy = {'numpy', 'mitsuba', 'OpenImageIO', 'skimage', 'click', 'rich', 'jinja2'}\n"
        "print(sorted((set(sys.modules) - before) & heavy))\n"
    )
    assert python(program).stdout == "[]\n"


def test_a_folder_is_an_item_for_each_scene_and_renderer_and_nothing_else(
    pytester: pytest.Pytester, scenes: Path
) -> None:
    """They pass where the renderers are right; other tests are not collected."""
    result = run(pytester, "--crosstrace", scenes, "--crosstrace-renderers", "native,povray", "-v")
    result.assert_outcomes(passed=4)
    result.stdout.fnmatch_lines([
        "*ball.txt::native PASSED*", "*ball.txt::povray PASSED*",
        "*sky.txt::native PASSED*", "*sky.txt::povray PASSED*",
    ])  # fmt: skip


def test_scenes_and_other_tests_run_together_where_both_are_named(
    pytester: pytest.Pytester, scenes: Path
) -> None:
    """The option adds to the arguments of the command line."""
    words = ("--crosstrace", scenes / "sky.txt", "--crosstrace-renderers", "native")
    run(pytester, scenes / "test_other.py", *words).assert_outcomes(passed=2)


def test_a_wrong_renderer_fails_with_the_verdict_in_words_and_its_worst_regions(
    pytester: pytest.Pytester, scenes: Path
) -> None:
    """Without a traceback; the others pass, and a renderer of one's own can be named."""
    lanes = "native,fake_lanes:Plain,fake_lanes:Gradient"
    words = ("--crosstrace", scenes / "sky.txt", "--crosstrace-renderers", lanes)
    result = run(pytester, *words)
    result.assert_outcomes(passed=2, failed=1)
    result.stdout.fnmatch_lines([
        "sky: native and fake_lanes:Plain agree with the truth everywhere.*"
        "fake_lanes:Gradient: wrong on 192 pixels*",
        "fake_lanes:Gradient is off in:",
        "  192 pixels in rows 0-11, columns 0-15: blob on the whole image; worst (*), off by *",
    ])  # fmt: skip
    assert "Traceback" not in result.stdout.str()


def test_an_extra_tolerance_is_counted_as_equal(pytester: pytest.Pytester, scenes: Path) -> None:
    """A ramp between 0 and 1 is within 1 of any colour; the option is off by default."""
    words = ("--crosstrace", scenes / "sky.txt", "--crosstrace-renderers", "fake_lanes:Gradient")
    run(pytester, *words).assert_outcomes(failed=1)
    run(pytester, *words, "--crosstrace-tolerance", "1").assert_outcomes(passed=1)


def test_a_missing_renderer_fails_unless_the_user_allows_it(
    pytester: pytest.Pytester, scenes: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Skipped or failed, its reason is told; the others are judged."""
    monkeypatch.setenv("CROSSTRACE_POVRAY", NO_POVRAY["CROSSTRACE_POVRAY"])
    words = ("--crosstrace", scenes / "ball.txt", "--crosstrace-renderers", "native,povray", "-rs")
    result = run(pytester, *words)
    result.assert_outcomes(passed=1, failed=1)
    result.stdout.fnmatch_lines(["povray missing: *"])
    result = run(pytester, *words, "--crosstrace-missing", "skip")
    result.assert_outcomes(passed=1, skipped=1)
    result.stdout.fnmatch_lines(["SKIPPED*povray is missing: *"])


def test_a_renderer_that_crashes_or_refuses_fails_whatever_is_allowed(
    pytester: pytest.Pytester, scenes: Path
) -> None:
    """Only one that is not installed may be skipped."""
    lanes = "fake_lanes:Crashing,fake_lanes:Refusing"
    words = ("--crosstrace", scenes / "sky.txt", "--crosstrace-renderers", lanes)
    result = run(pytester, *words, "--crosstrace-missing", "skip")
    result.assert_outcomes(failed=2)
    result.stdout.fnmatch_lines(["fake_lanes:Refusing unsupported: no scene at all"])


def test_a_malformed_scene_fails_with_line_and_column(
    pytester: pytest.Pytester, scenes: Path
) -> None:
    """The others still run."""
    (scenes / "ball.txt").write_text("12 16 nonsense\n")
    result = run(pytester, "--crosstrace", scenes, "--crosstrace-renderers", "native")
    result.assert_outcomes(passed=1, failed=1)
    result.stdout.fnmatch_lines(["*ball.txt:1:7: expected *, found *"])


def test_the_size_can_be_chosen(pytester: pytest.Pytester, scenes: Path) -> None:
    """A wrong renderer is wrong on as many pixels as there are then."""
    words = ("--crosstrace", scenes / "sky.txt", "--crosstrace-renderers", "fake_lanes:Gradient")
    result = run(pytester, *words, "--crosstrace-size", "6x8")
    result.stdout.fnmatch_lines(["*wrong on 48 pixels*"])


@pytest.mark.parametrize("words", [
    ["--crosstrace", "nowhere"], ["--crosstrace", "."],
    ["--crosstrace", "scenes", "--crosstrace-size", "6"],
    ["--crosstrace", "scenes", "--crosstrace-tolerance", "-1"],
    ["--crosstrace", "scenes", "--crosstrace-tolerance", "nan"],
    ["--crosstrace", "scenes", "--crosstrace-renderers", "radiance"],
    ["--crosstrace", "scenes", "--crosstrace-missing", "pass"],
], ids=" ".join)  # fmt: skip
def test_wrong_options_are_refused(
    pytester: pytest.Pytester, scenes: Path, words: list[str]
) -> None:
    """As wrong usage of pytest."""
    result = run(pytester, *words)
    assert result.ret == pytest.ExitCode.USAGE_ERROR
    assert "Traceback" not in result.stderr.str()


def test_the_fixtures_judge_an_image_of_ones_own(pytester: pytest.Pytester, scenes: Path) -> None:
    """A test of somebody's renderer reads a scene and asserts that its image is right."""
    pytester.makepyfile("""
        import numpy as np

        def test_right(crosstrace_scene, crosstrace_compare):
            scene = crosstrace_scene("scenes/sky.txt")
            image = np.broadcast_to(scene.background / 255, scene.shape)
            opinion = crosstrace_compare(image, scene)
            assert opinion.right, str(opinion)
            assert opinion.counts["equal"] == 192

        def test_rounded_to_eight_bits(crosstrace_scene, crosstrace_compare):
            import crosstrace as ct
            scene = crosstrace_scene("scenes/ball.txt")
            exact = ct.render(scene, "native")
            image = np.rint(255 * exact) / 255
            assert not crosstrace_compare(image, scene).right
            assert crosstrace_compare(image, scene, half_step=1 / 510).verdict == "agree"
            assert crosstrace_compare(image, scene, tolerance=1 / 510).verdict == "agree"

        def test_single_precision(crosstrace_scene, crosstrace_compare):
            import crosstrace as ct
            scene = crosstrace_scene("scenes/ball.txt")
            image = ct.render(scene, "native", precision="f32")
            assert crosstrace_compare(image, scene, precision="f32").right
            assert not crosstrace_compare(image, scene).right

        def test_wrong(crosstrace_scene, crosstrace_compare):
            scene = crosstrace_scene("scenes/sky.txt")
            image = np.broadcast_to(scene.background / 255, scene.shape).copy()
            image[3, 5] += 0.25
            image[7, 7] = np.nan
            opinion = crosstrace_compare(image, scene)
            assert opinion.counts["wrong"] == 2 and opinion.n_regions == 2
            assert opinion.right, str(opinion)
    """)
    result = run(pytester, "-k", "not other")
    result.assert_outcomes(passed=3, failed=1)
    result.stdout.fnmatch_lines([
        "*disagree. No renderer agrees with the truth. the image: wrong on 2 pixels*",
        "*1 pixel in rows 3-3, columns 5-5: speckle on the background; worst (3, 5), off by 0.25*",
    ])  # fmt: skip
