"""The fixture of the scenes' tests."""

from official_scenes import official  # noqa: F401, pytest finds the fixture here
