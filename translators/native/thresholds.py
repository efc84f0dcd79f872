"""What a scene's index promises of each rung, and whether it is kept.

An index states under `stable`, by precision, the most pixels whose ray tree may differ from the
widest rung's among decidable pixels (`changed_trees`), and the greatest error in decidable pixels
with an unchanged tree (`error`), both at the scene's own size. The widest rung needs no entry: it
must stay inside the enclosures.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from crosstrace.translators.native.stability import Rung

Stated = Mapping[str, Mapping[str, float]]


def departures(rungs: Sequence[Rung], stated: Stated) -> list[str]:
    """Say in a sentence each how rungs, narrowest first, exceed what is stated; none: it is kept.

    A rung that is measured but not stated is one, too: a promise that is missing is not kept.
    """
    found = []
    for rung in rungs[:-1]:
        limits = stated.get(rung.precision)
        if limits is None:
            found.append(f"{rung.precision}: no threshold is stated")
        else:
            found += _exceeding(rung, limits["changed_trees"], limits["error"])
    return found + _exceeding(rungs[-1], 0, 0.0)


def _exceeding(rung: Rung, changed_trees: float, error: float) -> list[str]:
    found = []
    if rung.changed_decidable > changed_trees:
        found.append(
            f"{rung.precision}: expected at most {changed_trees:g} changed trees in decidable "
            f"pixels, found {rung.changed_decidable}"
        )
    if (rung.error_same_tree or 0.0) > error:
        found.append(
            f"{rung.precision}: expected errors of at most {error:g} where the tree is unchanged, "
            f"found {rung.error_same_tree:.3g}"
        )
    return found
