"""Numbers of one measurement, run by run."""

from __future__ import annotations

from dataclasses import dataclass, field

from crosstrace.translators.errors import CrosstraceError


@dataclass
class Runs:
    """Numbers of one measurement, run by run; or why there are none."""

    values: list[float] = field(default_factory=list)
    status: str = "ok"
    message: str = ""

    def fail(self, status: str, error: CrosstraceError | str) -> None:
        """Take note that there will be none."""
        self.values, self.status, self.message = [], status, str(error)
