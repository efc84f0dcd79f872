"""A pixel's ray tree in a line, and the objects that it meets."""

from __future__ import annotations

from crosstrace.translators.native.explain import PixelTree, Ray, RayKind

#: Rays that are written out; the others are counted.
WRITTEN = 8

_KINDS = {
    RayKind.PRIMARY: "hits",
    RayKind.REFLECTED: "reflected to",
    RayKind.REFRACTED: "refracted to",
    RayKind.TOTALLY_REFLECTED: "totally reflected to",
}


def outline(tree: PixelTree) -> str:
    """Write the rays depth first: ``hits 3, light 0 behind 2; reflected to 0; refracted to -``.

    Of shadow rays only blocked ones are named; ``-`` is the background, ``inside`` the inner side.
    """
    parts: list[str] = []
    written = 0
    n_rays = sum(ray.kind != RayKind.SHADOW for ray in tree.rays)
    for ray in tree.rays:
        if ray.kind == RayKind.SHADOW:
            if ray.object >= 0 and parts and written <= WRITTEN:
                parts[-1] += f", light {ray.light} behind {ray.object}"
            continue
        written += 1
        if written <= WRITTEN:
            parts.append(f"{_KINDS[ray.kind]} {_hit(ray)}")
    rest = n_rays - WRITTEN
    return "; ".join(parts) + (f"; {rest:,} more rays" if rest > 0 else "")


def _hit(ray: Ray) -> str:
    if ray.object < 0:
        return "-"
    return f"{ray.object} inside" if ray.inside else f"{ray.object}"


def objects_met(tree: PixelTree, beyond: float = 0.0) -> frozenset[int]:
    """Return the objects that any ray of the pixel hits, blocking ones of shadow rays included.

    Only hits at least `beyond` world units from the ray's start count.
    """
    return frozenset(ray.object for ray in tree.rays if ray.object >= 0 and ray.t_world >= beyond)
