"""The ledger declares what is approximated, with the objects concerned, and nothing else."""

from __future__ import annotations

from collections.abc import Callable

from crosstrace.translators.ledger import Entry
from crosstrace.translators.povray.adapter import PovRay
from crosstrace.translators.scene import Scene, plane, sphere

GLASS = {"ks": 0.2, "kt": 0.8, "n": 1.5}


def find(entries: list[Entry], words: str) -> Entry | None:
    """Return the one entry whose situation holds some words."""
    found = [entry for entry in entries if words in entry.situation]
    assert len(found) <= 1
    return found[0] if found else None


def test_every_image_is_quantised(make_scene: Callable[..., Scene]) -> None:
    """An empty scene still comes through 16-bit samples, half a step apart from exact."""
    (entry,) = PovRay().ledger(make_scene())
    assert (entry.effect, entry.fidelity, entry.bound) == ("output", "approximated", 1 / 131070)


def test_crossing_glass_names_its_objects(make_scene: Callable[..., Scene]) -> None:
    """Only the transparent surfaces that cross are listed, by their place in the file."""
    scene = make_scene(
        objects=[
            sphere([9, 9, 9], [0, 5, 0], 0.5, **GLASS),
            sphere([9, 9, 9], [0, 0, 0], 1.0, **GLASS),
            sphere([9, 9, 9], [1, 0, 0], 1.0, **GLASS),
            sphere([9, 9, 9], [0, 0, 1], 1.0, ka=0.5),
        ]
    )
    entry = find(PovRay().ledger(scene), "cross")
    assert entry is not None
    assert (entry.effect, entry.fidelity, entry.objects) == ("refraction", "approximated", (1, 2))


def test_disjoint_and_nested_glass_is_not_declared_crossing(
    make_scene: Callable[..., Scene],
) -> None:
    """A bubble in glass is exact."""
    scene = make_scene(objects=[sphere([9, 9, 9], [0, 0, 0], 1.0, **GLASS),
                                sphere([9, 9, 9], [0, 0, 0], 0.5, **GLASS)])  # fmt: skip
    assert find(PovRay().ledger(scene), "cross") is None


def test_faint_rays_are_declared_beyond_the_greatest_depth(
    make_scene: Callable[..., Scene],
) -> None:
    """Only a scene that asks for more than 255 bounces goes without its faintest rays."""
    objects = [sphere([9, 9, 9], [0, 0, 0], 1.0, ka=0.5), sphere([9, 9, 9], [0, 9, 0], 1.0, kr=0.5)]
    for depth, declared in ((255, ()), (256, (1,))):
        entry = find(PovRay().ledger(make_scene(objects=objects, max_depth=depth)), "carry less")
        assert (entry.objects if entry else ()) == declared


def test_planes_end(make_scene: Callable[..., Scene]) -> None:
    """The distance at which planes end is told in the scene's units."""
    scene = make_scene(objects=[plane([9, 9, 9], [0, 0, -1], [0, 0, 1], ka=0.5)])
    entry = find(PovRay().ledger(scene), "planes end")
    assert entry is not None
    assert (entry.effect, entry.objects) == ("geometry", (0,))


def test_indices_that_float32_changes_are_declared(make_scene: Callable[..., Scene]) -> None:
    """1.5 is exact in float32 and 1.4 is not; 1 is moved by a step."""
    scene = make_scene(objects=[sphere([9, 9, 9], [i * 3, 9, 0], 1.0, kt=0.5, n=n)
                                for i, n in enumerate((1.5, 1.4, 1.0))])  # fmt: skip
    entries = PovRay().ledger(scene)
    rounded, stepped = find(entries, "kept in float32, each"), find(entries, "float32 step")
    assert rounded is not None
    assert stepped is not None
    assert (rounded.objects, stepped.objects) == ((1,), (2,))


def test_a_camera_too_near_to_a_surface_is_declared(make_scene: Callable[..., Scene]) -> None:
    """POV-Ray ignores hits that near; a camera exactly on a surface is no such case."""
    for height, declared in ((1e-9, True), (0.0, False), (1.0, False)):
        floor = plane([9, 9, 9], [0, 0, 1 - height], [0, 0, 1], ka=0.5)
        entries = PovRay().ledger(make_scene(objects=[floor]))
        assert (find(entries, "camera is nearer") is not None) == declared
