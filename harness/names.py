"""File names made from names that users chose."""

from __future__ import annotations

import re


def slug(name: str, taken: set[str]) -> str:
    """Return a portable file name like `name`, different from those in `taken`, and take it."""
    plain = re.sub(r"[^A-Za-z0-9._-]+", "_", name).strip("._")[:80] or "unnamed"
    candidate, count = plain, 1
    # Some file systems do not tell cases apart.
    while candidate.lower() in taken:
        count += 1
        candidate = f"{plain}-{count}"
    taken.add(candidate.lower())
    return candidate
