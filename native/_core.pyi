"""The native library over CPython's limited API; its contract is in `include/crosstrace.h`."""

from collections.abc import Callable
from typing import Any

version: str
compiler: str

class Block:
    """One array of a parsed scene, as a read-only buffer of bytes."""

def parse(
    text: bytes | bytearray | memoryview, delivery: int = 0, /
) -> tuple[tuple[Any, ...], None] | tuple[None, tuple[int, int, str, str]]:
    """Return the scene tuple of `Scene.native_view()`, or (line, column, expected, found)."""

def check_scene(scene: tuple[Any, ...], /) -> tuple[str, str, str] | None:
    """Return None, or (where, expected, found) of the first number that makes no sense."""

def readings() -> list[tuple[str, str, str]]:
    """Return (name, default, values separated by |) of every reading."""

def precisions() -> list[str]:
    """Return the precisions that exist on this platform, narrowest first."""

def instructions() -> list[str]:
    """Return the instruction sets that this processor has, "generic" first."""

def check_reading(name: str, value: str, /) -> tuple[str, str] | None:
    """Return None, or (expected, found)."""

def certify(
    scene: tuple[Any, ...],
    settings: list[tuple[str, str]],
    pixels: Any,
    tolerance: float,
    kappa: float,
    outputs: dict[str, Any],
    progress: Callable[[float], object] | None,
    /,
) -> dict[str, int]:
    """Enclose pixels and return how many each type of bounds certified.

    `pixels` is a C-contiguous int64 array of row·h_res + column, or None for all. `outputs` maps
    names to arrays with one entry a pixel: lo, hi (3 float64), pixel_class, level, decision,
    n_alternatives (uint8), depth, object (int32), alternatives (16 × 2 × 3 float64). `kappa` is 0
    for truth, else the relative error of the arithmetic under test. Raises as `render`.
    """

def perturb(
    scene: tuple[Any, ...],
    settings: list[tuple[str, str]],
    pixels: Any,
    samples: int,
    error: float,
    seed: int,
    outputs: dict[str, Any],
    progress: Callable[[float], object] | None,
    /,
) -> None:
    """Render pixels `samples` times each in double with random errors of that relative size.

    `pixels` is as in `certify`. `outputs` maps names to arrays with one entry a pixel: colors
    (samples × 3 float64), trees (samples uint64). With error 0 every sample equals `render`'s
    pixel. Raises as `render`.
    """

def explain(
    scene: tuple[Any, ...],
    settings: list[tuple[str, str]],
    row: int,
    column: int,
    capacity: int,
    progress: Callable[[float], object] | None,
    /,
) -> tuple[list[tuple[Any, ...]], int, int, tuple[float, float, float]]:
    """Record the rays of one pixel in double: (rays, how many there are, tree hash, colour).

    The first `capacity` rays are in the list, depth first, each a tuple: kind, parent, depth,
    object, light, margin_decision, margin_object, inside, total, weight, t_world, light_distance,
    margin, then triples: origin, direction, point, normal, color, base, diffuse, specular, unsent;
    clearance. Their meaning is that of `ct_ray_record`. Raises as `render`.
    """

def intersect(
    scene: tuple[Any, ...],
    settings: list[tuple[str, str]],
    n: int,
    origins: Any,
    directions: Any,
    passes: int,
    outputs: dict[str, Any],
    tree: Any = None,
    /,
) -> float:
    """Find the nearest hit of n rays, by the code that renders, in this thread.

    Returns the processor time in seconds that they took, without what is done once for a scene.

    `origins` and `directions` are (3, n) float64, directions of length 1; `outputs` are t (n,)
    float64, infinite where nothing is hit, and object (n,) int64, then -1. Each block of
    some rays is traced `passes` times. `tree` is what `tree` made of the same arrays; without it
    one is built wherever `render` would. Raises as `render`.
    """

def peak_flops(instructions: str, seconds: float, /) -> float:
    """Return the most float64 products and sums a second, not fused, of one core; 0 without any."""

def call_each(
    function: int, arguments: tuple[int, int, int, int], which: int, stride: int, count: int, /
) -> None:
    """Call a C function `count` times with four addresses, of which one grows by `stride`.

    For measuring other libraries, where a loop in Python would cost more than the calls.
    """

def render(
    scene: tuple[Any, ...],
    settings: list[tuple[str, str]],
    outputs: dict[str, Any],
    progress: Callable[[float], object] | None,
    tree: Any = None,
    cells: Any = None,
    side: int = 1,
    /,
) -> dict[str, int]:
    """Render into the caller's arrays and return the ray counts.

    `settings` are readings and precision, rounding (nearest, up, down, zero), instructions (the
    most to use: generic, fma, avx2, avx512, native), search (auto, scan, tree: how objects are
    found, the same bits), threads, effects, tolerance, ray_budget, jitter (a seed), row_begin,
    row_end, as texts. `outputs` maps names to C-contiguous arrays over the rendered rows: image
    (3 float64 a pixel), object (int32), t (float64), normal (3 float64), tree (uint64), rays
    (uint32), contributions (6 × 3 float64), image_low (3 float64: what rounding `image` to double
    left out).
    Raises ValueError for a wrong setting or array, RuntimeError where the tracer gave up, and
    whatever `progress` raised. `tree` is what `tree()` returned of the same arrays: many spheres
    are then not sorted again. `cells`, a C-contiguous int64 array, asks for some squares of
    side × side pixels, row·(h_res/side) + column; arrays then have one entry a pixel of them, in
    that order.
    """

def tree(scene: tuple[Any, ...], progress: Callable[[float], object] | None, /) -> Any:
    """Sort a scene's spheres into a tree, for several calls of `render`.

    `progress` is called with 0, and ends the work by an exception. Raises MemoryError besides.
    """
