"""Large images in bands: the numbers and files of whole ones; what does not fit is refused."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from crosstrace.harness import alone, bands, images, memory, tasks
from crosstrace.harness.comparison import compare, compare_rows
from crosstrace.harness.display import DisplayRule
from crosstrace.harness.lanes import loaded
from crosstrace.harness.row_files import reading, writing
from crosstrace.translators.errors import UnsupportedSceneError, UsageError
from crosstrace.translators.native import adapter
from crosstrace.translators.renderer import RenderOptions
from crosstrace.translators.scene import Scene, plane, sphere

SHAPE = (83, 37, 3)


@pytest.fixture
def short_bands(monkeypatch: pytest.MonkeyPatch) -> None:
    """Cut images of this size into many bands, the last of which is short."""
    monkeypatch.setattr(bands, "PIXELS", 20 * SHAPE[1])


def _pair() -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(5)
    a = rng.random(SHAPE) * 1.5
    b = a + rng.normal(0, 0.05, SHAPE) * (rng.random(SHAPE) > 0.5)
    b[30:70] = a[30:70]
    return a, b


def _scene(rows: int = 50, columns: int = 40) -> Scene:
    return Scene.build(
        delivery=1, v_res=rows, h_res=columns, pixel_size=0.03, screen_distance=1.0,
        eye=np.array([0.0, -6, 1]), target=np.zeros(3), up=np.array([0.0, 0, 1]),
        background=np.array([90.0, 120, 200]),
        objects=[sphere([200, 100, 50], [0, 0, 0], 1), plane([9, 99, 9], [0, 0, -1], [0, 0, 1])],
    )  # fmt: skip


def test_bands_cover_every_row_once() -> None:
    """One band up to a size; beyond it bands of equal height but for the last."""
    assert list(bands.cut(1080, 1920)) == [(0, 1080)]
    cut = list(bands.cut(16384, 16384))
    assert [begin for begin, _ in cut] == [0, *(end for _, end in cut[:-1])]
    assert cut[-1][1] == 16384
    assert max(end - begin for begin, end in cut) * 16384 <= bands.PIXELS


@pytest.mark.usefixtures("short_bands")
def test_the_similarity_in_bands_is_that_of_the_whole_image() -> None:
    """Every value of the map to the last bit, as each band sees the rows beside it."""
    from skimage.metrics import structural_similarity

    from crosstrace.harness.display import display_color

    a, b = _pair()
    mean, full = structural_similarity(
        display_color(a), display_color(b), data_range=1.0, channel_axis=-1,
        gaussian_weights=True, sigma=1.5, use_sample_covariance=False, full=True,
    )  # fmt: skip
    found = compare(a, b).similarity
    assert found.map is not None
    assert np.array_equal(found.map, full)
    assert found.mean == pytest.approx(mean, rel=1e-14)


def test_metrics_in_bands_are_those_of_the_whole_image(monkeypatch: pytest.MonkeyPatch) -> None:
    """Counts and extremes to the last bit, sums but for the order of adding."""
    a, b = _pair()
    whole = compare(a, b).record()
    monkeypatch.setattr(bands, "PIXELS", 20 * SHAPE[1])
    banded = compare(a, b).record()
    for key, value in whole.items():
        if key in ("mean", "bias", "rmse", "psnr", "ssim"):
            assert banded[key] == pytest.approx(value, rel=1e-13)
        else:
            assert banded[key] == value


@pytest.mark.usefixtures("short_bands")
@pytest.mark.parametrize("suffix", [".npy", ".npz", ".pfm", ".exr", ".png", ".ppm"])
def test_files_compare_as_the_arrays_in_them(tmp_path: Path, suffix: str) -> None:
    """Read by rows or whole, in bands: one record, to the last bit."""
    paths = [tmp_path / f"{name}{suffix}" for name in "ab"]
    for path, image in zip(paths, _pair(), strict=True):
        images.write(path, image)
    expected = compare(images.read(paths[0]), images.read(paths[1])).record()
    with reading(paths[0]) as first, reading(paths[1]) as second:
        assert compare_rows(first, second).record() == expected


@pytest.mark.usefixtures("short_bands")
def test_one_value_that_is_not_finite_in_one_band_leaves_no_similarity() -> None:
    """Wherever the band is."""
    a, b = _pair()
    b[60, 3, 1] = np.nan
    assert compare(a, b).ssim is None
    assert compare(a, b).metrics.nonfinite == 1


def test_identical_images_in_bands_are_identical() -> None:
    """Also where their similarity is not worked out."""
    a, _ = _pair()
    with_itself = compare_rows(bands.RowsInMemory(a), bands.RowsInMemory(a.copy()))
    assert with_itself.ssim == 1.0
    assert with_itself.metrics.identical


def test_files_of_other_sizes_are_refused() -> None:
    """Nothing is cut to make them fit."""
    a, _ = _pair()
    with pytest.raises(UsageError, match="one size, found 83x37 and 80x37"):
        compare_rows(bands.RowsInMemory(a), bands.RowsInMemory(a[:80]))


@pytest.mark.parametrize("suffix", [".npy", ".npz", ".pfm", ".exr", ".png", ".ppm"])
def test_a_file_written_by_rows_is_the_one_written_whole(tmp_path: Path, suffix: str) -> None:
    """The same pixels and metadata, whatever the bands."""
    image, _ = _pair()
    metadata = {"scene": "some", "settings": "{}"}
    whole, by_rows = tmp_path / f"whole{suffix}", tmp_path / f"rows{suffix}"
    images.write(whole, image, metadata=metadata)
    with writing(by_rows, SHAPE, metadata) as write:
        for begin in range(0, SHAPE[0], 20):
            write(image[begin : begin + 20])
    (expected, first), (found, second) = map(images.read_with_metadata, (whole, by_rows))
    assert np.array_equal(found, expected)
    ours = [{k: v for k, v in m.items() if k.startswith(images.PREFIX)} for m in (first, second)]
    assert ours[0] == ours[1]


def test_rendering_in_bands_gives_the_whole_image(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Every pixel to the last bit; the rays are those of all bands, and progress only grows."""
    monkeypatch.setattr(adapter, "BAND_PIXELS", 16 * 40)
    scene = _scene()
    told: list[float] = []
    whole = adapter.Native().render(scene, RenderOptions())
    made, _ = tasks.render_to_file(
        scene, RenderOptions(), str(tmp_path / "x.npy"), {}, DisplayRule(), told.append
    )
    assert np.array_equal(images.read(tmp_path / "x.npy"), whole.image)
    assert made.settings["rays"]["primary"] == whole.settings["rays"]["primary"] == 50 * 40
    assert told == sorted(told)


def test_a_rendering_that_fails_leaves_no_file(tmp_path: Path) -> None:
    """Neither half an image nor a temporary one."""
    options = RenderOptions(readings={"tir": "nonsense"})
    with pytest.raises(UsageError):
        alone.render_to_file(_scene(), options, tmp_path / "x.exr", {}, DisplayRule())
    assert list(tmp_path.iterdir()) == []


def test_what_does_not_fit_into_memory_is_refused_and_says_so(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """With what it needs and what there is, before anything is rendered."""
    monkeypatch.setattr(tasks, "available_bytes", lambda: 2 * 2**30)
    big = replace(_scene(), v_res=16384, h_res=16384)
    with pytest.raises(UnsupportedSceneError, match=r"16384x16384 pixels needs about 40\.0 GiB"):
        tasks.drawn(loaded("povray"), big, RenderOptions())
    tasks.check_memory(loaded("povray"), _scene(), RenderOptions())


def test_the_free_memory_is_known_on_linux() -> None:
    """A limit that is not known refuses nothing."""
    free = memory.available_bytes()
    assert free is None or free > 0
