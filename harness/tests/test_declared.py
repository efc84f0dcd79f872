"""Declarations that no reading reproduces: counted apart where the ray tree meets them."""

from __future__ import annotations

import numpy as np

import crosstrace as ct
from crosstrace.harness.declared import met
from crosstrace.harness.ray_path import objects_met, outline
from crosstrace.translators.ledger import Arithmetic, Entry, Ledger
from crosstrace.translators.native.explain import explain

ARITHMETIC = Arithmetic(2.0**-53, 4.0, 2.0**-53)


def scene() -> ct.Scene:
    return ct.load("overlapping-glass")


def test_a_pixel_counts_only_where_its_rays_meet_the_objects_of_the_entry() -> None:
    """Of all pixels, those that see the object at any depth; a reading that reproduces it: none."""
    it = scene()
    everywhere = np.ones((it.v_res, it.h_res), bool)
    seen = {
        (row, column)
        for row in range(it.v_res)
        for column in range(it.h_res)
        if 1 in objects_met(explain(it, row, column))
    }
    assert 0 < len(seen) < everywhere.size
    only = np.zeros_like(everywhere)
    only[tuple(np.array(sorted(seen)[:20]).T)] = True
    ledger = Ledger((Entry("geometry", "object 1", "approximated", objects=(1,)),), ARITHMETIC)
    (found,) = met(it, ledger, only)
    assert (found.pixels, found.looked_at) == (20, 20)
    (found,) = met(it, ledger, everywhere)
    assert found.looked_at == 256
    assert abs(found.pixels / 256 - len(seen) / everywhere.size) < 0.1
    proven = Entry("geometry", "object 1", "approximated", objects=(1,), readings=("offset",))
    assert met(it, Ledger((proven,), ARITHMETIC), everywhere) == []


def test_hits_nearer_than_the_entry_says_do_not_count() -> None:
    """A disk's end is met only by rays that go as far."""
    it = scene()
    far = Entry("geometry", "far away", "approximated", objects=tuple(range(len(it))), beyond=1e8)
    assert met(it, Ledger((far,), ARITHMETIC), np.ones((it.v_res, it.h_res), bool)) == []


def test_an_outline_names_hits_in_the_order_of_tracing() -> None:
    """Depth first, with what blocks the lights; many rays are counted."""
    it = scene()
    tree = explain(it, 30, 40)
    text = outline(tree)
    assert text.startswith(f"hits {tree.rays[0].object}")
    assert "refracted to" in text and text.endswith("more rays")
