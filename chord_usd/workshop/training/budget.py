"""The minutes that a training run may take."""

from __future__ import annotations

import time


class Budget:
    """A run's clock, started when it is made."""

    def __init__(self, minutes: float, *, processor_time: bool = False) -> None:
        """minutes: positive; infinity for a run that somebody else ends. processor_time: count what
        this process has of the processors, so that a busy machine takes nothing from a run."""
        self.minutes = minutes
        self._now = time.process_time if processor_time else time.monotonic
        self.started = self._now()
        self._last_done: dict[str, float] = {}

    @property
    def spent(self) -> float:
        """Minutes since the start."""
        return (self._now() - self.started) / 60.0

    @property
    def share(self) -> float:
        """Of the minutes, those spent; [0, 1]."""
        return min(self.spent / self.minutes, 1.0)

    @property
    def is_over(self) -> bool:
        """Whether all are spent."""
        return self.spent > self.minutes

    def is_due(self, what: str, every_minutes: float) -> bool:
        """Whether so many have gone by since this was last due, or since the start."""
        if self.spent - self._last_done.get(what, 0.0) <= every_minutes:
            return False
        self._last_done[what] = self.spent
        return True
