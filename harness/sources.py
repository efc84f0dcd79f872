"""From what the user names to scenes: a file, a folder of files, or a packaged scene's name."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from importlib.resources import as_file, files
from importlib.resources.abc import Traversable
from pathlib import Path
from typing import Any

from crosstrace.harness import scene_index
from crosstrace.translators.course import load
from crosstrace.translators.errors import UsageError
from crosstrace.translators.scene import Scene

#: Packaged collections: the course's names, numerically hard scenes, and scenes to measure with.
COURSE, HARD, BENCH = "course", "hard", "bench"


@dataclass(frozen=True)
class Source:
    """A scene under the name by which a report tells it from others; `title` may be empty.

    `expected` is what the scene's index says of the verdict where another renderer is known to be
    wrong: its `verdict`, the lanes to `blame`, and the `cause`. It is of the scene at its own size;
    None: the verdict is to be `agree` or `explained`. A folder of anybody's may have an index.
    `stable` is what the index of a packaged scene promises of each precision
    (translators/native/thresholds.py).
    """

    name: str
    scene: Scene
    title: str = ""
    about: str = ""
    packaged: bool = False
    expected: Mapping[str, Any] | None = None
    stable: Mapping[str, Mapping[str, float]] = field(default_factory=dict)


def packaged_names() -> tuple[str, ...]:
    """Return the names of the packaged course scenes, in the order of their index."""
    return tuple(_index(COURSE))


def hard_names() -> tuple[str, ...]:
    """Return the names of the packaged hard scenes, in the order of their index."""
    return tuple(_index(HARD))


def bench_names() -> tuple[str, ...]:
    """Return the names of the packaged scenes to measure with; no suite has them."""
    return tuple(_index(BENCH))


def all_packaged_names() -> tuple[str, ...]:
    """Return the names of the packaged course scenes and then of the numerically hard ones."""
    return (*packaged_names(), *hard_names())


def find(
    texts: Iterable[str] = (),
    *,
    delivery: int | None = None,
    size: tuple[int, int] | None = None,
) -> list[Source]:
    """Read every scene named; none named: the packaged course scenes.

    `size` (rows, columns) overrides the resolution. Names are made different where they are not.
    Raises UsageError for what is neither a file, a folder with scenes nor a packaged name, and
    SceneError for the first scene that is malformed, before anything is rendered.
    """
    found: list[Source] = []
    for text in list(texts) or packaged_names():
        found += _sources(text, delivery)
    if not found:
        raise UsageError("expected scenes, found none")
    taken: set[str] = set()
    return [_distinct(_resized(source, size), taken) for source in found]


def find_one(
    text: str, *, delivery: int | None = None, size: tuple[int, int] | None = None
) -> Source:
    """Read one scene; raises UsageError where a folder is named that holds several."""
    found = find([text], delivery=delivery, size=size)
    if len(found) > 1:
        raise UsageError(f"{text}: expected one scene, found a folder of {len(found)}")
    return found[0]


def from_scenes(
    scenes: Iterable[Scene | Source], size: tuple[int, int] | None = None
) -> list[Source]:
    """Name scenes for a report, differently where they share a name; `size` as for `find`."""
    taken: set[str] = set()
    named = (it if isinstance(it, Source) else _named(it) for it in scenes)
    return [_distinct(_resized(source, size), taken) for source in named]


def sized(scene: Scene, size: tuple[int, int] | None, most_rows: int) -> Scene:
    """Return a scene at a size (rows, columns); None: its own, reduced to so many rows at most."""
    if size is not None:
        return scene.resized(*size)
    if scene.v_res <= most_rows:
        return scene
    return scene.resized(most_rows, max(1, round(scene.h_res * most_rows / scene.v_res)))


def _named(scene: Scene) -> Source:
    prefix, _, name = scene.path.partition(":")
    found = _packaged(name) if prefix == "crosstrace" else None
    if found is None:
        return Source(scene.name or "scene", scene)
    return _titled(Source(name, scene, packaged=found[0] == COURSE), found[1])


def _packaged(name: str) -> tuple[str, dict[str, Any]] | None:
    """Return the collection and the index entry of a packaged scene."""
    for collection in (COURSE, HARD, BENCH):
        entry = _index(collection).get(name)
        if entry is not None:
            return collection, entry
    return None


def _titled(source: Source, entry: Mapping[str, Any]) -> Source:
    """Add what an index says."""
    return replace(
        source, title=entry.get("title", entry.get("family", "")), about=entry.get("about", ""),
        expected=entry.get("expected"), stable=entry.get("stable", {}),
    )  # fmt: skip


def _sources(text: str, delivery: int | None) -> list[Source]:
    path = Path(text)
    if path.is_dir():
        inside = sorted(path.glob("*.txt"))
        if not inside:
            raise UsageError(f"{text}: expected a folder of .txt scenes, found none")
        about = scene_index.entries(path)
        sources = [_from_file(file, delivery) for file in inside]
        return [_titled(source, about.get(source.name, {})) for source in sources]
    if path.exists():
        return [_from_file(path, delivery)]
    found = _packaged(text)
    if found is None:
        known = ", ".join((*all_packaged_names(), *bench_names()))
        raise UsageError(
            f"{text}: expected a scene file, a folder or a packaged scene ({known}), found neither"
        )
    collection, entry = found
    with as_file(_folder(collection) / entry["file"]) as file:
        scene = replace(load(file, delivery), path=f"crosstrace:{text}", name=text)
    return [_titled(Source(text, scene, packaged=collection == COURSE), entry)]


def _from_file(path: Path, delivery: int | None) -> Source:
    scene = load(path, delivery)
    return Source(scene.name, scene)


def _resized(source: Source, size: tuple[int, int] | None) -> Source:
    if size is None:
        return source
    return replace(source, scene=source.scene.resized(*size), expected=None)


def _distinct(source: Source, taken: set[str]) -> Source:
    name, count = source.name, 1
    while name in taken:
        count += 1
        name = f"{source.name}-{count}"
    taken.add(name)
    return replace(source, name=name)


def _folder(collection: str) -> Traversable:
    return files("crosstrace.scenes") / collection


def _index(collection: str) -> dict[str, dict[str, Any]]:
    return scene_index.entries(_folder(collection))
