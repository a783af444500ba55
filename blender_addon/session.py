"""The one job that may run, and what to do when it ends; it lives as long as Blender does."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import bpy

from .core.job import Job, Outcome
from .preferences import program
from .properties import fields

POLL_EVERY_S = 0.2

Finish = Callable[[bpy.types.Context, dict[str, Any]], None]
"""What to do with the program's report."""


class Session:
    """Runs jobs one at a time; a timer looks after the running one while Blender stays usable."""

    def __init__(self) -> None:
        self.job: Job | None = None
        self._finish: Finish | None = None

    @property
    def is_running(self) -> bool:
        """Whether a job runs now."""
        return self.job is not None and self.job.outcome is None

    def start(self, context: bpy.types.Context, arguments: Sequence[str], finish: Finish) -> None:
        """Start a job. Raises core.program.ProgramError where there is no program for it."""
        self.job = Job([*program(context).command, *arguments])
        self._finish = finish
        fields(context).error = ""
        self.job.start()
        bpy.app.timers.register(self._tick, first_interval=POLL_EVERY_S)

    def step(self, context: bpy.types.Context) -> bool:
        """Look after the job once; True while it runs."""
        if self.job is None:
            return False
        running = self.job.poll()
        if not running and self._finish is not None:
            finish, self._finish = self._finish, None
            assert self.job.outcome is not None
            self._end(context, self.job.outcome, finish)
        return running

    def cancel(self) -> None:
        """Stop the running job."""
        if self.job is not None:
            self.job.cancel()

    def _tick(self) -> float | None:
        running = self.step(bpy.context)
        for window in bpy.context.window_manager.windows:
            for area in window.screen.areas:
                if area.type == "VIEW_3D":
                    area.tag_redraw()
        return POLL_EVERY_S if running else None

    @staticmethod
    def _end(context: bpy.types.Context, outcome: Outcome, finish: Finish) -> None:
        if outcome.cancelled:
            return
        if outcome.data is None:
            fields(context).error = outcome.error
            return
        finish(context, outcome.data)
        bpy.ops.ed.undo_push(message="CHOrD")


session = Session()
