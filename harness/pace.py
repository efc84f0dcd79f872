"""How fast work goes and how long it will take, in few words."""

from __future__ import annotations

import time
from collections.abc import Callable

#: Before so much of the work is done, or time has passed, nothing is foretold.
_LEAST_STEPS, _LEAST_S = 1.0, 0.5


class Pace:
    """Steps done against the clock, from when it is made; `clock` gives seconds."""

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        """Start the clock."""
        self._clock = clock
        self._started = clock()

    def text(self, done: float, total: float, counted: bool = True) -> str:
        """Say rate and time left, or the time taken where all is done; empty: too early to tell.

        Where steps are not `counted` they are shares of one, of which a rate says nothing.
        """
        elapsed = self._clock() - self._started
        if done >= total:
            return f"in {duration(elapsed)}"
        if elapsed < _LEAST_S or (counted and done < _LEAST_STEPS) or done <= 0:
            return ""
        left = f"{duration(elapsed * (total - done) / done)} left"
        return f"{rate(done / elapsed)}, {left}" if counted else left


def rate(a_second: float) -> str:
    """Write steps a second in at most seven characters: 12/s, 1.3/s; below one seconds a step."""
    if a_second >= 0.95:
        return f"{a_second:.2g}/s" if a_second < 99.5 else f"{a_second:.0f}/s"
    return f"{1 / a_second:.2g}s each" if 1 / a_second < 99.5 else f"{1 / a_second:.0f}s each"


def duration(seconds: float) -> str:
    """Write a time in the two units that matter: 0.4 s, 45 s, 3 min 20 s, 2 h 5 min."""
    if seconds < 9.95:
        return f"{seconds:.1f} s"
    whole = round(seconds)
    if whole < 60:
        return f"{whole} s"
    if whole < 600:
        return f"{whole // 60} min {whole % 60} s"
    minutes = round(seconds / 60)
    return f"{minutes} min" if minutes < 60 else f"{minutes // 60} h {minutes % 60} min"
