"""The table of all goldens: it says what they say."""

from __future__ import annotations

from pathlib import Path

from crosstrace.harness import verdict_table
from crosstrace.harness.goldens import located
from crosstrace.harness.sources import all_packaged_names


def test_the_packaged_table_is_that_of_the_packaged_goldens(tmp_path: Path) -> None:
    """Written anew from the goldens it is the same text, with every packaged scene in it."""
    reference = located(None)
    names = list(all_packaged_names())
    goldens = [golden for name in names if (golden := reference.read(name)) is not None]
    text = (reference.folder / verdict_table.FILE).read_text(encoding="utf-8")
    assert verdict_table.markdown(goldens) == text
    assert len(goldens) == len(names)


def test_blessing_writes_the_table_of_the_folder(tmp_path: Path) -> None:
    """A suite of anybody's gets one, too: scenes in the order given, counts with their commas."""
    from crosstrace.harness import regression
    from crosstrace.harness.session import RunOptions
    from crosstrace.harness.sources import find

    sources = find(["venn", "japao"], size=(16, 20))
    regression.bless(sources, located(tmp_path), "a reason", RunOptions(("native",)))
    text = (tmp_path / verdict_table.FILE).read_text(encoding="utf-8")
    assert "| venn | agree |  | native | 320 |" in text
    assert text.index("| japao |") < text.index("| venn |")
