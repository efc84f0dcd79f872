"""Every error that a scene or a renderer can cause, with the data to act on it."""

from __future__ import annotations


class CrosstraceError(Exception):
    """An error for the user: it is printed without a traceback."""


class SceneError(CrosstraceError):
    """A scene that is malformed or makes no sense.

    A scene read from text knows its line and column (both from 1); a scene built in Python has
    neither, and `where` names the field instead, as in ``objects[3].radius``.
    """

    def __init__(
        self, path: str, line: int, column: int, expected: str, found: str, where: str = ""
    ) -> None:
        """Keep the parts: path, line and column from 1 (0: unknown), expected and found texts."""
        self.path, self.line, self.column = path, line, column
        self.expected, self.found, self.where = expected, found, where
        place = f"{path}:{line}:{column}" if line else f"{path}: {where}" if where else path
        super().__init__(f"{place}: expected {expected}, found {found}")

    def __reduce__(self) -> tuple[type[SceneError], tuple[str, int, int, str, str, str]]:
        """Pickle by parts, so that a worker process can send it back."""
        parts = (self.path, self.line, self.column, self.expected, self.found, self.where)
        return SceneError, parts


class UsageError(CrosstraceError):
    """A wrong option, file name or combination: exit status 2."""


class RendererError(CrosstraceError):
    """A renderer that was asked for an image and failed: reported, never a pass."""


class RendererTimeoutError(RendererError):
    """A renderer that gave no image within its time limit and was killed."""


class RendererMissingError(RendererError):
    """A renderer that is not installed or cannot work here.

    `remedy` is the line to type, or an empty text.
    """

    def __init__(self, reason: str, remedy: str = "") -> None:
        """Keep the reason (one sentence) and the remedy (a command)."""
        self.reason, self.remedy = reason, remedy
        super().__init__(reason + (f" (install it with: {remedy})" if remedy else ""))

    def __reduce__(self) -> tuple[type[RendererMissingError], tuple[str, str]]:
        """Pickle by parts, so that a worker process can send it back."""
        return RendererMissingError, (self.reason, self.remedy)


class UnsupportedSceneError(RendererError):
    """A scene that this renderer cannot express or hold, said before any work is done."""
