"""A plugin of pytest: scenes as tests, and fixtures for tests of one's own renderer.

`pytest --crosstrace scenes/` collects the folder's scenes in the course's format, one item a scene
and renderer, and nothing else; an item fails where its renderer is wrong. Without that option
nothing is collected and nothing is imported. `--crosstrace-renderers` also takes
``module:factory`` for a renderer from outside this package.

Fixtures: `crosstrace_scene(name_or_file, size=…)` reads a scene, and
`crosstrace_compare(image, scene)` judges an image of yours against the truth of the scene.
"""

from __future__ import annotations

import re
import tempfile
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from crosstrace.harness.against_truth import Opinion
    from crosstrace.harness.jobs import WorkerPool
    from crosstrace.translators.scene import Scene

_FILES = pytest.StashKey[frozenset[Path]]()
_POOL = pytest.StashKey["WorkerPool"]()

#: Regions that a failure describes.
_REGIONS = 5


class SceneFailedError(Exception):
    """A renderer that is wrong about a scene, or has no image; the text says how."""


def pytest_addoption(parser: pytest.Parser) -> None:
    """Add the options."""
    group = parser.getgroup("crosstrace", "ray-traced scenes against the truth")
    group.addoption(
        "--crosstrace", action="append", metavar="PATH",
        help="Collect the scenes (.txt) of a folder, or one file; may be repeated.",
    )  # fmt: skip
    group.addoption(
        "--crosstrace-renderers", metavar="A,B",
        help="Only these: of native,mitsuba,mitsuba-f64,povray, or module:factory.",
    )  # fmt: skip
    group.addoption(
        "--crosstrace-tolerance", type=_tolerance, default=0.0, metavar="X",
        help="Count so much more as equal, on linear float; default: 0.",
    )  # fmt: skip
    group.addoption(
        "--crosstrace-size", type=_size, metavar="RxC",
        help="Other rows x columns, same field of view.",
    )  # fmt: skip
    group.addoption(
        "--crosstrace-missing", choices=("fail", "skip"), default="fail",
        help="What becomes of the items of a renderer that is not installed; default: fail.",
    )  # fmt: skip


def pytest_configure(config: pytest.Config) -> None:
    """Have the named scenes collected, alone where no other argument is given."""
    named = config.getoption("--crosstrace")
    if not named:
        return
    _lanes(config)  # refuses a wrong name before anything is collected
    found = _scene_files(config.invocation_params.dir, named)
    config.stash[_FILES] = frozenset(found)
    if config.args_source is not pytest.Config.ArgsSource.ARGS:
        config.args.clear()
    config.args.extend(str(file) for file in found)


def pytest_unconfigure(config: pytest.Config) -> None:
    """End the workers."""
    if (pool := config.stash.get(_POOL, None)) is not None:
        pool.shutdown()


def pytest_collect_file(file_path: Path, parent: pytest.Collector) -> pytest.Collector | None:
    """Collect a scene that was asked for."""
    if file_path.resolve() not in parent.config.stash.get(_FILES, frozenset()):
        return None
    collected: SceneFile = SceneFile.from_parent(parent, path=file_path)
    return collected


class SceneFile(pytest.File):
    """A scene: rendered and judged once, by all renderers, when its first item runs."""

    _outcome: Mapping[str, Any] | Exception | None = None

    def collect(self) -> Iterable[pytest.Item]:
        """Return an item for each renderer."""
        return [SceneItem.from_parent(self, name=lane) for lane in _lanes(self.config)]

    def judged(self) -> Mapping[str, Any]:
        """Return the record of the scene, as in a report; raises what was wrong with the scene."""
        if self._outcome is None:
            try:
                self._outcome = self._run()
            except Exception as error:
                self._outcome = error
        if isinstance(self._outcome, Exception):
            raise self._outcome
        return self._outcome

    def _run(self) -> Mapping[str, Any]:
        from crosstrace.harness.session import RunOptions, run
        from crosstrace.harness.sources import find_one

        config = self.config
        source = find_one(str(self.path), size=config.getoption("--crosstrace-size"))
        tolerance = config.getoption("--crosstrace-tolerance")
        options = RunOptions(_lanes(config), tolerance=tolerance)
        with tempfile.TemporaryDirectory(prefix="crosstrace-", ignore_cleanup_errors=True) as out:
            report = run([source], Path(out) / "report", options, executor=_pool(config))
        scene: Mapping[str, Any] = report["scenes"][0]
        return scene


class SceneItem(pytest.Item):
    """One renderer's image of a scene."""

    def runtest(self) -> None:
        """Fail where the renderer is wrong about the scene, or did not render it."""
        assert isinstance(self.parent, SceneFile)
        scene = self.parent.judged()
        lane = next(entry for entry in scene["renderers"] if entry["name"] == self.name)
        if lane["status"] == "missing" and self.config.getoption("--crosstrace-missing") == "skip":
            pytest.skip(f"{self.name} is missing: {lane['message']}")
        if lane["status"] != "ok":
            raise SceneFailedError(f"{self.name} {lane['status']}: {lane['message']}")
        if scene["judgement"]["message"]:
            raise SceneFailedError(f"not judged: {scene['judgement']['message']}")
        if self.name in scene["blame"] or _is_open(scene, lane):
            raise SceneFailedError(_failure(scene, lane))

    def repr_failure(self, excinfo: pytest.ExceptionInfo[BaseException], style: Any = None) -> Any:
        """Say what is wrong without a traceback."""
        from crosstrace.translators.errors import CrosstraceError

        if isinstance(excinfo.value, SceneFailedError | CrosstraceError):
            return str(excinfo.value)
        return super().repr_failure(excinfo, style)

    def reportinfo(self) -> tuple[Path, None, str]:
        """Return where the item stands and its title."""
        return self.path, None, f"{self.path.stem} by {self.name}"


@pytest.fixture(scope="session")
def crosstrace_scene() -> Callable[..., Scene]:
    """Return `crosstrace.load`: reads a scene from a file or by its packaged name."""
    from crosstrace.harness.api import load

    return load


@pytest.fixture(scope="session")
def crosstrace_compare() -> Callable[..., Opinion]:
    """Return `compare_with_truth`: the verdict on a linear image (v_res, h_res, 3) of a scene.

    ``assert opinion.right, str(opinion)`` says in words what is wrong, and where.
    """
    from crosstrace.harness.against_truth import compare_with_truth

    return compare_with_truth


def _scene_files(start: Path, named: Iterable[str]) -> list[Path]:
    found: dict[Path, None] = {}
    for text in named:
        path = (start / text).resolve()
        files = sorted(path.glob("*.txt")) if path.is_dir() else [path]
        if not files or not all(file.is_file() for file in files):
            raise pytest.UsageError(f"--crosstrace {text}: expected a scene or a folder of .txt "
                                    "scenes, found none")  # fmt: skip
        found.update(dict.fromkeys(files))
    return list(found)


def _lanes(config: pytest.Config) -> tuple[str, ...]:
    from crosstrace.harness.lanes import LANES, chosen
    from crosstrace.translators.errors import UsageError

    text = config.getoption("--crosstrace-renderers")
    if text is None:
        return LANES
    words = [word.strip() for word in text.split(",") if word.strip()]
    try:
        inside = [word for word in words if ":" not in word]
        own = chosen(inside) if inside or not words else ()
    except UsageError as error:
        raise pytest.UsageError(f"--crosstrace-renderers: {error}") from None
    return (*own, *(word for word in dict.fromkeys(words) if ":" in word))


def _pool(config: pytest.Config) -> WorkerPool:
    from crosstrace.harness.jobs import WorkerPool, available_cores

    if _POOL not in config.stash:
        slots = available_cores()
        config.stash[_POOL] = WorkerPool(slots, threads=1 if slots > 1 else 0)
    return config.stash[_POOL]


def _is_open(scene: Mapping[str, Any], lane: Mapping[str, Any]) -> bool:
    """Say whether more of an image is undecidable than a verdict allows."""
    from crosstrace.harness.blame import UNDECIDABLE_SHARE

    allowed = UNDECIDABLE_SHARE * scene["v_res"] * scene["h_res"]
    return bool(lane["classes"]["undecidable"] > allowed)


def _failure(scene: Mapping[str, Any], lane: Mapping[str, Any]) -> str:
    from crosstrace.harness.against_truth import told
    from crosstrace.harness.outcome import sentence

    shown = [f"  {told(region)}" for region in lane["regions"][:_REGIONS]]
    more = (lane["n_regions"] or 0) - len(shown)
    where = [f"{lane['name']} is off in:", *shown] if shown else []
    rest = [f"  and {more:,} other places"] if more > 0 else []
    return "\n".join([f"{scene['name']}: {sentence(scene)}", *where, *rest])


def _tolerance(text: str) -> float:
    value = float(text)
    if not 0.0 <= value < float("inf"):
        raise ValueError
    return value


def _size(text: str) -> tuple[int, int]:
    match = re.fullmatch(r"([1-9][0-9]{0,6})[x×]([1-9][0-9]{0,6})", text, re.ASCII)
    if match is None:
        raise ValueError
    return int(match[1]), int(match[2])
