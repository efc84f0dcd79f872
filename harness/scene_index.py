"""The index of a folder of scenes, `index.json`: titles, and the verdicts that are expected.

A list with one object a scene: `name` or `file` says which; `title`, `family` and `about` are for
people; `expected` (`verdict`, `blame`, `cause`) is where another renderer is known to be wrong.
"""

from __future__ import annotations

import json
from importlib.resources.abc import Traversable
from typing import Any

from crosstrace.translators.errors import UsageError

VERDICTS = ("agree", "explained", "disagree")


def entries(folder: Traversable) -> dict[str, dict[str, Any]]:
    """Return the entries by scene name, in order; none without an index.

    Raises UsageError for an index that is not as above.
    """
    try:
        text = (folder / "index.json").read_text(encoding="utf-8")
    except (FileNotFoundError, NotADirectoryError):
        return {}
    except UnicodeDecodeError as error:
        raise _error(folder, "UTF-8", str(error)) from None
    try:
        listed = json.loads(text)
    except ValueError as error:
        raise _error(folder, "JSON", str(error)) from None
    if not isinstance(listed, list):
        raise _error(folder, "a list of scenes", type(listed).__name__)
    found = {}
    for entry in listed:
        name = _name(entry)
        if name is None:
            raise _error(folder, "an object with the name or file of a scene", repr(entry)[:60])
        if (expected := entry.get("expected")) is not None:
            _check_expected(folder, name, expected)
        found[name] = entry
    return found


def _name(entry: Any) -> str | None:
    if not isinstance(entry, dict):
        return None
    name = entry.get("name") or str(entry.get("file", "")).removesuffix(".txt")
    return name if isinstance(name, str) and name else None


def _check_expected(folder: Traversable, name: str, expected: Any) -> None:
    well_formed = (
        isinstance(expected, dict)
        and expected.get("verdict") in VERDICTS
        and isinstance(expected.get("blame"), list)
        and all(isinstance(lane, str) for lane in expected["blame"])
        and isinstance(expected.get("cause"), str)
    )
    if not well_formed:
        keys = f"a verdict ({', '.join(VERDICTS)}), a list of lanes to blame, and a cause"
        raise _error(folder, f"{keys} as what is expected of {name}", repr(expected)[:80])


def _error(folder: Traversable, expected: str, found: str) -> UsageError:
    return UsageError(f"{folder / 'index.json'}: expected {expected}, found {found}")
